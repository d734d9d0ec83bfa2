# Simulated fingers of the paper's table, whatever campaign is looked at.
rule assumptions:
    output:
        assumptions=OUT / "assumptions.nc",
    log:
        OUT / "logs/assumptions.log",
    params:
        config=choose_settings(config, "assumptions"),
        seed=config["seed"],
        code=code_hash("assumptions"),
        environment=ENVIRONMENT,
    message:
        "Check the paper's assumptions against the full equations of motion"
    script:
        "../scripts/assumptions.py"
