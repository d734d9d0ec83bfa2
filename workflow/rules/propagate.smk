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
        config=config["propagation"],
        seed=config["seed"],
        code=code_hash("propagate"),
    message:
        "Propagate the spread of the parameters to bands and densities of the angles"
    script:
        "../scripts/propagate.py"
