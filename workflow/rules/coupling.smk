# Single asperities beside an elastic half-space; only in scenes with coupling.surfaces > 0
rule coupling:
    input:
        f"{RESULTS}/coupling/comparison.csv",


rule compare_half_space:
    message:
        "compare with an elastic half-space"
    input:
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/coupling/comparison.csv",
    log:
        f"{RESULTS}/logs/compare_half_space.log",
    params:
        settings=settings("coupling"),
        contact=settings("contact"),
    threads: 1
    script:
        "../scripts/compare_half_space.py"
