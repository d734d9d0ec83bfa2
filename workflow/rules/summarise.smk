ARTIFACTS = [
    "angles",
    "doubts",
    "least_squares",
    "posterior",
    "sampling",
    "bands",
    "densities",
    "sobol",
    "shapley",
    "assumptions",
]
ARTIFACTS += DIAGNOSIS
if VIDEOS:
    ARTIFACTS += ["picture", "tracking_quality"]
SUMMED = ["checks", "summary"]


rule summarise:
    input:
        **MODEL,
        **{name: OUT / f"{name}.nc" for name in ARTIFACTS},
        verdict=OUT / "verdict.json",
        markers=expand(OUT / "markers/{batch}.nc", batch=BATCHES),
    output:
        checks=OUT / "checks.nc",
        summary=OUT / "summary.nc",
    log:
        OUT / "logs/summarise.log",
    params:
        config=choose_settings(config, "summarise"),
        seed=config["seed"],
        code=code_hash("summarise"),
        environment=ENVIRONMENT,
    message:
        "Sum up what the artifacts contain, and check it"
    script:
        "../scripts/summarise.py"
