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
        config=config["propagation"],
        seed=config["seed"],
        code=code_hash("sobol"),
    message:
        "Split the spread of the angles among the parameters"
    script:
        "../scripts/sobol.py"


rule shapley:
    input:
        angles=OUT / "angles.nc",
        posterior=OUT / "posterior.nc",
    output:
        shapley=OUT / "shapley.nc",
    log:
        OUT / "logs/shapley.log",
    params:
        config=config["propagation"],
        seed=config["seed"],
        code=code_hash("shapley"),
    message:
        "Look for parameters that go together, and share the spread among them"
    script:
        "../scripts/shapley.py"
