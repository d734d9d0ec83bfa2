rule track:
    input:
        tables=TABLES,
        videos=batch_videos,
    output:
        markers=OUT / "markers/{batch}.nc",
    log:
        OUT / "logs/track_{batch}.log",
    params:
        folder=CAMPAIGN,
        trials=batch_trials,
        seed=config["seed"],
        code=code_hash("track"),
    message:
        "Track the markers in batch {wildcards.batch}"
    script:
        "../scripts/track.py"
