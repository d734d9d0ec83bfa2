rule propagate:
    input:
        **MODEL,
        angles=OUT / "angles.nc",
        least_squares=OUT / "least_squares.nc",
        posterior=OUT / "posterior.nc",
    output:
        bands=OUT / "bands.nc",
        densities=OUT / "densities.nc",
    log:
        OUT / "logs/propagate.log",
    params:
        config=choose_settings(config, "propagate"),
        seed=config["seed"],
        code=code_hash("propagate"),
        environment=ENVIRONMENT,
    message:
        "Propagate the spread of the parameters to bands and densities of the angles"
    script:
        "../scripts/propagate.py"
