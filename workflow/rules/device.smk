rule device:
    input:
        f"{RESULTS}/device/switch.json",
        f"{RESULTS}/device/law.csv",


rule solve_switch:
    input:
        **SURFACE,
        samples=f"{RESULTS}/uq/samples.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        wells=f"{RESULTS}/law/wells.csv",
    output:
        switch=report(f"{RESULTS}/device/switch.json", caption="../captions/switch.rst", category="Device"),
        release=f"{RESULTS}/device/release.csv",
        stiction=f"{RESULTS}/device/stiction.csv",
        table=report(f"{RESULTS}/device/law.csv", caption="../captions/device_law.rst", category="Device"),
        samples=f"{RESULTS}/device/law.json",
        spice=f"{RESULTS}/device/asperity_contact.sub",
        testbench=f"{RESULTS}/device/asperity_contact.cir",
        verilog=f"{RESULTS}/device/asperity_contact.va",
    log:
        f"{RESULTS}/logs/solve_switch.log",
    params:
        device=settings("device"),
        law=settings("law"),
        contact=settings("contact"),
    message:
        "solve the switch, and export the law for device and circuit simulators"
    script:
        "../scripts/solve_switch.py"
