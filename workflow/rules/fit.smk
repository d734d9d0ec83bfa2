rule least_squares:
    input:
        angles=OUT / "angles.nc",
    output:
        least_squares=OUT / "least_squares.nc",
    log:
        OUT / "logs/least_squares.log",
    params:
        config=config["estimation"],
        seed=config["seed"],
        code=code_hash("least_squares"),
    message:
        "Fit each trial by least squares, the paper's way"
    script:
        "../scripts/least_squares.py"


rule fit:
    input:
        **MODEL,
        angles=OUT / "angles.nc",
    output:
        posterior=OUT / "posterior.nc",
        sampling=OUT / "sampling.nc",
    log:
        OUT / "logs/fit.log",
    threads: config["estimation"]["cores"]
    params:
        config=config["estimation"],
        seed=config["seed"],
        code=code_hash("fit"),
    message:
        "Sample the hierarchical posterior"
    script:
        "../scripts/fit.py"
