rule write_scene:
    output:
        f"{RESULTS}/scene.yaml",
    log:
        f"{RESULTS}/logs/write_scene.log",
    params:
        scene=RESOLVED,
    message:
        "record the resolved scene"
    script:
        "../scripts/write_scene.py"
