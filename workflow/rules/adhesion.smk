# Energy and pull-off of pads against roughness, load and attraction; only in scenes with adhesion.pads > 0
ADHESION = SCENE.adhesion
ADHESION_CASES = [f"{k:03d}" for k in range(ADHESION.case_count)]


rule adhesion:
    input:
        f"{RESULTS}/adhesion/summary.csv",


rule open_pads:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
    output:
        f"{RESULTS}/adhesion/pads/case_{{adhesion_case}}.csv",
    log:
        f"{RESULTS}/logs/open_pads_{{adhesion_case}}.log",
    wildcard_constraints:
        adhesion_case="\\d+",
    threads: 1
    resources:
        mem_mb=contact_MB(SCENE.contact, ADHESION.cells),
    params:
        contact=settings("contact"),
        adhesion=settings("adhesion"),
    message:
        f"open pads from several loads, case {{wildcards.adhesion_case}} of {len(ADHESION_CASES)}"
    script:
        "../scripts/open_pads.py"


rule summarise_adhesion:
    input:
        [f"{RESULTS}/adhesion/pads/case_{case}.csv" for case in ADHESION_CASES],
    output:
        f"{RESULTS}/adhesion/summary.csv",
    log:
        f"{RESULTS}/logs/summarise_adhesion.log",
    threads: 1
    message:
        "summarise the adhesion of pads"
    script:
        "../scripts/summarise_adhesion.py"
