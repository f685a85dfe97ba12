from workflow.files.checksums import file_checksum

STYLE = [str(ROOT / "workflow" / "report" / name) for name in ("template.html.j2", "style.css")]


def studies_at_hand():
    """Tables of studies already present, with their checksums.

    As parameters, not inputs: they are shown without being scheduled, and a new one renews
    the page.
    """
    return {name: file_checksum(name) for name in (*ACCURACY, *STABILITY) if Path(name).is_file()}


rule report:
    """the page, and all that it needs"""
    input:
        SHOWN,
        style=STYLE,
    output:
        page=f"{RESULTS}/report.html",
        record=f"{RESULTS}/scene.yaml",
    log:
        f"{RESULTS}/logs/report.log",
    params:
        contents=contents(*STYLE),
        root=RESULTS,
        scene=RESOLVED,
        studies=lambda wildcards: studies_at_hand(),
    message:
        "write the report"
    script:
        "../scripts/render_report.py"
