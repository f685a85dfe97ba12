rule write_scene:
    message:
        "record the resolved scene"
    output:
        f"{RESULTS}/scene.yaml",
    log:
        f"{RESULTS}/logs/write_scene.log",
    params:
        scene=RESOLVED,
    script:
        "../scripts/write_scene.py"
