# Single asperities beside an elastic half-space; only in scenes with coupling.surfaces > 0
rule coupling:
    input:
        f"{RESULTS}/coupling/comparison.csv",


rule compare_half_space:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/coupling/comparison.csv",
    log:
        f"{RESULTS}/logs/compare_half_space.log",
    threads: 1
    params:
        settings=settings("coupling"),
        contact=settings("contact"),
    message:
        "compare with an elastic half-space"
    script:
        "../scripts/compare_half_space.py"
