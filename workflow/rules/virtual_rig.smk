# The instrument simulator: only run when the config names no campaign folder.
if SIMULATED:

    rule virtual_rig:
        input:
            **MODEL,
        output:
            TABLES,
            truth=OUT / "truth.nc",
        log:
            OUT / "logs/virtual_rig.log",
        params:
            folder=CAMPAIGN,
            config=choose_settings(config, "virtual_rig"),
            seed=config["seed"],
            code=code_hash("virtual_rig"),
            environment=ENVIRONMENT,
        message:
            "Draw a finger's trials and move it by the full equations of motion"
        script:
            "../scripts/virtual_rig.py"

    for batch, names in BATCHES.items():

        rule:
            name:
                f"film_{batch}"
            input:
                truth=OUT / "truth.nc",
            output:
                videos=[VIDEOS[name] for name in names],
            log:
                OUT / f"logs/film_{batch}.log",
            params:
                config=choose_settings(config, "film"),
                seed=config["seed"],
                code=code_hash("film"),
                environment=ENVIRONMENT,
            message:
                f"Film {len(names)} trials, from {names[0]}"
            script:
                "../scripts/film.py"
