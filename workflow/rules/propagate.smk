rule propagate:
    input:
        angles=OUT / "angles.nc",
        least_squares=OUT / "least_squares.nc",
        posterior=OUT / "posterior.nc",
    output:
        bands=OUT / "bands.nc",
        densities=OUT / "densities.nc",
    params:
        config=config["propagation"],
        seed=config["seed"],
        code=code_hash("propagate"),
    log:
        OUT / "logs/propagate.log",
    message:
        "Propagate the spread of the parameters to bands and densities of the angles"
    script:
        "../scripts/propagate.py"
