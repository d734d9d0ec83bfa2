ARTIFACTS = [
    "angles",
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
FIGURES = [
    "finger",
    "joint_model",
    "recordings",
    "histograms",
    "initial_angles",
    "densities",
]
FIGURES += [
    "bands",
    "bands_early",
    "sobol",
    "shapley",
    "hyperparameters",
    "residuals",
    "sampling",
]
FIGURES += [
    "assumptions",
    "repair",
    "ranking",
    "location",
    "masking",
    "prior_predictive",
]
if VIDEOS:
    FIGURES += ["tracking"]


if MODEL:  # Shapley effects and these residuals know the base model alone
    ARTIFACTS.remove("shapley")
    FIGURES = [name for name in FIGURES if name not in ("shapley", "residuals")]


rule report:
    input:
        **{name: OUT / f"{name}.nc" for name in ARTIFACTS},
        verdict=OUT / "verdict.json",
        markers=expand(OUT / "markers/{batch}.nc", batch=BATCHES),
    output:
        report=report(
            OUT / "report.html",
            caption="../report/report.rst",
            category="Report",
            labels={"page": "report"},
        ),
    log:
        OUT / "logs/report.log",
    params:
        config=config,
        code=code_hash("report"),
    message:
        "Write the report"
    script:
        "../scripts/report.py"


rule figure:
    input:
        **{name: OUT / f"{name}.nc" for name in ARTIFACTS},
        verdict=OUT / "verdict.json",
        markers=expand(OUT / "markers/{batch}.nc", batch=BATCHES),
    output:
        figures=[
            OUT / "figures/{name}.pdf",
            OUT / "figures/{name}.png",
            report(
                OUT / "figures/{name}.svg",
                caption="../report/figure.rst",
                category="Figures",
                labels={"figure": "{name}"},
            ),
        ],
    log:
        OUT / "logs/figure_{name}.log",
    params:
        name="{name}",
        config=config,
        code=code_hash("figure"),
    message:
        "Draw figure {wildcards.name}"
    script:
        "../scripts/figure.py"


rule document:
    input:
        **{name: OUT / f"{name}.nc" for name in ARTIFACTS},
        verdict=OUT / "verdict.json",
        markers=expand(OUT / "markers/{batch}.nc", batch=BATCHES),
    output:
        document=OUT / "figures/figures.tex",
        table=report(
            OUT / "figures/parameters.tex",
            caption="../report/table.rst",
            category="Tables",
            labels={"table": "parameters"},
        ),
    log:
        OUT / "logs/document.log",
    params:
        names=FIGURES,
        config=config,
        code=code_hash("document"),
    message:
        "Write the LaTeX document of the figures"
    script:
        "../scripts/document.py"


rule figures:
    input:
        expand(OUT / "figures/{name}.pdf", name=FIGURES),
        OUT / "figures/figures.tex",


rule check_artifacts:
    input:
        artifacts=[OUT / f"{name}.nc" for name in ARTIFACTS],
        markers=expand(OUT / "markers/{batch}.nc", batch=BATCHES),
    output:
        receipt=OUT / "receipt.csv",
    log:
        OUT / "logs/check_artifacts.log",
    params:
        code=code_hash("check_artifacts"),
    message:
        "Check every artifact against its declaration"
    script:
        "../scripts/check_artifacts.py"
