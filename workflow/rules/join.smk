# Campaigns of one finger as one: only where the config names several folders.
if JOINED:

    rule join:
        input:
            tables=[table for campaign in JOINED for table in list_tables(campaign)],
            videos=[
                trial.recording
                for campaign in JOINED
                for trial in campaign.trials
                if trial.level == "video"
            ],
        output:
            TABLES,
        log:
            OUT / "logs/join.log",
        params:
            folders=SEVERAL,
            target=CAMPAIGN,
            config={
                "tracking": choose_settings(config, "angles"),
                "trials_per_job": config["trials_per_job"],
            },
            code=code_hash("join"),
            environment=ENVIRONMENT,
        message:
            f"Join {len(SEVERAL)} campaigns"
        script:
            "../scripts/join.py"
