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
    priority: 1  # most rules wait for it, and it waits until all its cores are free
    threads: config["estimation"]["cores"]
    params:
        config=config["estimation"],
        seed=config["seed"],
        code=code_hash("fit"),
    message:
        "Sample the hierarchical posterior"
    script:
        "../scripts/fit.py"


# Calibration, asked for by name: only a simulated campaign has a truth to be held against.
if SIMULATED:

    rule recovery:
        input:
            truth=OUT / "truth.nc",
            least_squares=OUT / "least_squares.nc",
            posterior=OUT / "posterior.nc",
        output:
            recovery=OUT / "recovery.nc",
            table=OUT / "recovery.csv",
        log:
            OUT / "logs/recovery.log",
        params:
            seed=config["seed"],
            code=code_hash("recovery"),
        message:
            "Hold both ways of fitting against the simulated truth"
        script:
            "../scripts/recovery.py"
