rule conceal:
    output:
        campaign=directory(OUT / "campaign/{case}"),
        truth=OUT / "truth/{case}.json",
        salt=OUT / "salt/{case}.txt",
        seal=OUT / "seal/{case}.txt",
    log:
        OUT / "logs/conceal_{case}.log",
    params:
        place=find_place,
        suite=SUITE,
        config=choose_settings(DEFAULTS, "film"),
        seed=config["seed"],
        code=code_hash("conceal"),
        environment=ENVIRONMENT,
    message:
        "Conceal physics in campaign {wildcards.case}, and seal the truth"
    script:
        "../scripts/conceal.py"


rule diagnose_blind:
    input:
        campaign=OUT / "campaign/{case}",
        seal=OUT / "seal/{case}.txt",
    output:
        diagnosis=directory(OUT / "diagnosis/{case}"),
        answer=OUT / "answer/{case}.json",
        digest=OUT / "digest/{case}.txt",
    log:
        OUT / "logs/diagnose_{case}.log",
    params:
        patience_s=config["patience_s"],
        mcmc=is_sampled,
        code=code_hash("diagnose_blind", *COMMAND_LINE),
        environment=ENVIRONMENT,
        settings=DIAGNOSED,
    message:
        "Diagnose campaign {wildcards.case} blind"
    script:
        "../scripts/diagnose_blind.py"


rule diagnose_measured:
    input:
        campaign=REAL / "{recording}",
    output:
        diagnosis=directory(OUT / "measured/{recording}"),
        answer=OUT / "measured/{recording}.json",
        digest=OUT / "measured/{recording}.txt",
    log:
        OUT / "logs/measured_{recording}.log",
    params:
        patience_s=config["patience_s"],
        mcmc=False,
        code=code_hash("diagnose_blind", *COMMAND_LINE),
        environment=ENVIRONMENT,
        settings=DIAGNOSED,
    message:
        "Diagnose the real recordings {wildcards.recording}"
    script:
        "../scripts/diagnose_blind.py"


rule rivals:
    input:
        OUT / "diagnosis/{case}",
    output:
        OUT / "rivals/{case}.json",
    log:
        OUT / "logs/rivals_{case}.log",
    params:
        python=sys.executable,
        code=code_hash("benchmarks.rivals.naive_search"),
        environment=ENVIRONMENT,
    message:
        "Ask two rivals about campaign {wildcards.case}"
    shell:
        "{params.python} -m benchmarks.rivals.naive_search {input}/angles.nc {output} 2> {log}"


rule limit:
    input:
        OUT / "digest/{case}.txt",  # the answer stands before the truth is read
        truth=OUT / "truth/{case}.json",
    output:
        limit=OUT / "limit/{case}.json",
    log:
        OUT / "logs/limit_{case}.log",
    params:
        code=code_hash("limit"),
        environment=ENVIRONMENT,
    message:
        "Ask what the oracle itself could name of campaign {wildcards.case}"
    script:
        "../scripts/limit.py"


rule score:
    input:
        **{
            part: [
                OUT / f"{part}/{case}.{'txt' if part in TEXTS else 'json'}"
                for case in CASES
            ]
            for part in (*TEXTS, "truth", "answer")
        },
        limits=[OUT / f"limit/{case}.json" for case in LIMITED],
        rivals=[OUT / f"rivals/{case}.json" for case in COMPARED],
        measured=[OUT / f"measured/{name}.json" for name in KNOWN],
        diagnoses=[OUT / f"diagnosis/{case}" for case in CASES],
    output:
        score=OUT / "score.html",
        table=OUT / "score.csv",
        figures=OUT / "benchmarks.json",
    log:
        OUT / "logs/score.log",
    params:
        seed=config["seed"],
        known=config["measured"],
        code=code_hash("score"),
        environment=ENVIRONMENT,
    message:
        "Open the seals and score the answers"
    script:
        "../scripts/score.py"
