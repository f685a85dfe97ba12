# Repeated closing and creep; only in scenes with history.cycles > 0

from workflow.scene.memory import history_MB


rule history:
    """cycle after cycle, with creep"""
    input:
        required(SCENE.history.cycles > 0, "history.cycles = 0: give the cycles of each surface"),
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        cycles=captioned(f"{RESULTS}/history/cycles.csv"),
        dwell=f"{RESULTS}/history/dwell.csv",
    log:
        f"{RESULTS}/logs/history.log",
    resources:
        mem_mb=history_MB(SCENE.history, SCENE.contact),
    params:
        settings=settings("history"),
        contact=settings("contact"),
    message:
        "close and open again and again"
    script:
        "../scripts/follow_history.py"


if SCENE.history.cycles > 0:
    SHOWN += rules.history.output
