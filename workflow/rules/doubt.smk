rule doubt:
    input:
        angles=OUT / "angles.nc",
    output:
        doubts=OUT / "doubts.nc",
    log:
        OUT / "logs/doubt.log",
    params:
        code=code_hash("doubt"),
        environment=ENVIRONMENT,
    message:
        "Look for what looks wrong in the recordings"
    script:
        "../scripts/doubt.py"
