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
        seed=config["seed"],
        code=code_hash("conceal"),
    message:
        "Conceal physics in campaign {wildcards.case}, and seal what it was"
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
        code=code_hash("diagnose_blind") + code_hash("diagnose"),
    message:
        "Diagnose campaign {wildcards.case}, of which nothing is known"
    script:
        "../scripts/diagnose_blind.py"


rule score:
    input:
        **{
            part: [
                OUT / f"{part}/{case}.{'txt' if part in TEXTS else 'json'}"
                for case in CASES
            ]
            for part in (*TEXTS, "truth", "answer")
        },
        diagnoses=[OUT / f"diagnosis/{case}" for case in CASES],
    output:
        score=OUT / "score.html",
        table=OUT / "score.csv",
        figures=OUT / "benchmarks.json",
    log:
        OUT / "logs/score.log",
    params:
        seed=config["seed"],
        code=code_hash("score"),
    message:
        "Open the seals and score the answers"
    script:
        "../scripts/score.py"
