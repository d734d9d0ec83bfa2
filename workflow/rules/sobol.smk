rule sobol:
    input:
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
