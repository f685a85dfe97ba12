from workflow.checksums import file_checksum

if needed("hardness"):
    SHOWN += [*rules.find_hardness.output, *rules.fit_hardness.output]
    SHOWN += expand(rules.run_closing.output, run=CLOSINGS)
    KEPT += expand(rules.make_glass.output, glass=SCENE.hardness.seeds)
    KEPT += expand(rules.make_counter_glass.output, glass=SCENE.hardness.seeds) if COUNTER_GLASS else []
if needed("elastic"):
    SHOWN += [*rules.fit_bulk_moduli.output, *rules.combine_e_star.output]
    SHOWN += rules.average_tensors.output if TENSORS else []
    KEPT += rules.fit_bulk_moduli.input
    KEPT += rules.average_tensors.input if TENSORS else []
    KEPT += expand([*rules.make_amorphous.output, *rules.relax_amorphous.output], amorphous=GLASSES)
if SCENE.measurements.tables:
    SHOWN += rules.sample_posterior.output
    if SCENE.pad.points and "pad" in SCENE.tails:
        SHOWN += rules.rank_next_on_pad.output
if SCENE.report.studies:
    SHOWN += [*ACCURACY, *STABILITY]


def studies_at_hand():
    """Tables of studies already present, with their checksums.

    As parameters, not inputs: they are shown without being scheduled, and a new one renews the page.
    """
    found = rules.model_form.input + ([] if SCENE.report.studies else [*ACCURACY, *STABILITY])
    return {name: file_checksum(name) for name in found if Path(name).is_file()}


def page_parts():
    """What the page is made of beside results."""
    room = ROOT / "workflow" / "report"
    return [str(room / "template.html.j2"), str(room / "style.css"), *sorted(map(str, room.glob("live/*.js")))]


rule report:
    """the page, and all that it needs"""
    input:
        SHOWN,
        style=page_parts(),
    output:
        page=f"{RESULTS}/report.html",
        record=f"{RESULTS}/scene.yaml",
    log:
        f"{RESULTS}/logs/report.log",
    params:
        root=RESULTS,
        scene=RESOLVED,
        studies=studies_at_hand(),
    message:
        "write the report"
    script:
        "../scripts/render_report.py"
