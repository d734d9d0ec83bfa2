DIAGNOSIS = [
    "ranking",
    "location",
    "masking",
    "repair",
    "free_form",
    "laws",
    "measurement",
]


rule diagnose:
    input:
        **MODEL,
        angles=OUT / "angles.nc",
    output:
        **{name: OUT / f"{name}.nc" for name in DIAGNOSIS},
        verdict=OUT / "verdict.json",
        repaired=OUT / "model.yaml",
        survivors=OUT / "survivors.yaml",
        next_experiment=directory(OUT / "next_experiment"),
    log:
        OUT / "logs/diagnose.log",
    threads: 1  # of linear algebra: the same bytes whatever the cores
    params:
        config=choose_settings(config, "diagnose"),
        r_hat_max=config["estimation"]["r_hat_max"],
        seed=config["seed"],
        code=code_hash("diagnose"),
        environment=ENVIRONMENT,
    message:
        "Find out which physics was left out, and repair the model"
    script:
        "../scripts/diagnose.py"
