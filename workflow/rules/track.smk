rule track:
    input:
        tables=TABLES,
        videos=batch_videos,
    output:
        markers=OUT / "markers/{batch}.nc",
    params:
        folder=CAMPAIGN,
        trials=batch_trials,
        config=config["tracking"],
        seed=config["seed"],
        code=code_hash("track"),
    log:
        OUT / "logs/track_{batch}.log",
    message:
        "Track the markers in batch {wildcards.batch}"
    script:
        "../scripts/track.py"
