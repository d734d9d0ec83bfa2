rule least_squares:
    input:
        **MODEL,
        angles=OUT / "angles.nc",
    output:
        least_squares=OUT / "least_squares.nc",
    log:
        OUT / "logs/least_squares.log",
    params:
        config=choose_settings(config, "least_squares"),
        code=code_hash("least_squares"),
        environment=ENVIRONMENT,
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
    log:
        OUT / "logs/fit.log",
    priority: 1  # most rules wait for it, and it waits until all its cores are free
    threads: config["estimation"]["cores"]
    params:
        config=choose_settings(config, "fit"),
        seed=config["seed"],
        code=code_hash("fit"),
        environment=ENVIRONMENT,
    message:
        "Sample the hierarchical posterior"
    script:
        "../scripts/fit.py"


rule sampling:
    input:
        posterior=OUT / "posterior.nc",
    output:
        sampling=OUT / "sampling.nc",
    log:
        OUT / "logs/sampling.log",
    params:
        config=choose_settings(config, "sampling"),
        code=code_hash("sampling"),
        environment=ENVIRONMENT,
    message:
        "Judge whether the sampling can be trusted"
    script:
        "../scripts/sampling.py"


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
            code=code_hash("recovery"),
            environment=ENVIRONMENT,
        message:
            "Compare both ways of fitting with the simulated truth"
        script:
            "../scripts/recovery.py"
