rule angles:
    input:
        tables=TABLES,
        markers=expand(OUT / "markers/{batch}.nc", batch=BATCHES),
    output:
        angles=OUT / "angles.nc",
    log:
        OUT / "logs/angles.log",
    params:
        folder=CAMPAIGN,
        config=choose_settings(config, "angles"),
        code=code_hash("angles"),
        environment=ENVIRONMENT,
    message:
        "Turn marker positions and angle tables into joint angles and loads"
    script:
        "../scripts/angles.py"
