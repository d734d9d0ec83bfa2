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
    "evidence",
    "repair",
    "ranking",
    "location",
    "masking",
    "prior_predictive",
    "measurement",
]
if VIDEOS:
    FIGURES += ["tracking"]


rule report:
    input:
        **{name: OUT / f"{name}.nc" for name in [*ARTIFACTS, *SUMMED]},
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
        environment=ENVIRONMENT,
    message:
        "Write the report"
    script:
        "../scripts/report.py"


rule figure:
    input:
        **{name: OUT / f"{name}.nc" for name in [*ARTIFACTS, *SUMMED]},
        verdict=OUT / "verdict.json",
        markers=expand(OUT / "markers/{batch}.nc", batch=BATCHES),
    output:
        figures=[
            OUT / "figures/{name}.pdf",
            OUT / "figures/{name}.png",
            OUT / "figures/{name}.csv",
            OUT / "figures/{name}.txt",
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
        code=code_hash("figure"),
        environment=ENVIRONMENT,
    message:
        "Draw figure {wildcards.name}"
    script:
        "../scripts/figure.py"


rule document:
    input:
        **{name: OUT / f"{name}.nc" for name in [*ARTIFACTS, *SUMMED]},
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
        code=code_hash("document"),
        environment=ENVIRONMENT,
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
        artifacts=[OUT / f"{name}.nc" for name in [*ARTIFACTS, *SUMMED]],
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
