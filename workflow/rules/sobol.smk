rule sobol:
    input:
        **MODEL,
        angles=OUT / "angles.nc",
        least_squares=OUT / "least_squares.nc",
        posterior=OUT / "posterior.nc",
    output:
        sobol=OUT / "sobol.nc",
    log:
        OUT / "logs/sobol.log",
    params:
        config=choose_settings(config, "sobol"),
        seed=config["seed"],
        code=code_hash("sobol"),
        environment=ENVIRONMENT,
    message:
        "Split the spread of the angles among the parameters"
    script:
        "../scripts/sobol.py"


rule shapley:
    input:
        **MODEL,
        angles=OUT / "angles.nc",
        posterior=OUT / "posterior.nc",
    output:
        shapley=OUT / "shapley.nc",
    log:
        OUT / "logs/shapley.log",
    params:
        config=choose_settings(config, "shapley"),
        seed=config["seed"],
        code=code_hash("shapley"),
        environment=ENVIRONMENT,
    message:
        "Look for correlated parameters, and share the spread among them"
    script:
        "../scripts/shapley.py"
