from workflow.files.checksums import file_checksum

STYLE = [str(ROOT / "workflow" / "report" / name) for name in ("template.html.j2", "style.css")]


rule report:
    """the page, and all that it needs"""
    input:
        SHOWN,
        style=STYLE,
    output:
        figures=report(
            directory(f"{RESULTS}/figures"),
            patterns=["{figure}.svg"],
            caption="../report/captions/figure.rst",
            category="Figures",
            labels={"figure": "{figure}"},
        ),
        record=f"{RESULTS}/scene.yaml",
        # last, so that Snakemake dates it last: an older page is one of former results
        page=report(
            f"{RESULTS}/report.html",
            caption="../report/captions/page.rst",
            category="Page",
        ),
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
