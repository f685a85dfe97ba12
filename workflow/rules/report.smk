from workflow.files.checksums import file_checksum

STYLE = [str(ROOT / "workflow" / "report" / name) for name in ("template.html.j2", "style.css")]


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
        scene=RESOLVED,
        # as parameters, not inputs: shown without being scheduled, and a new one renews the page
        studies=lambda wildcards: {
            name: file_checksum(name) for name in (*ACCURACY, *STABILITY) if Path(name).is_file()
        },
    message:
        "write the report"
    script:
        "../scripts/render_report.py"
