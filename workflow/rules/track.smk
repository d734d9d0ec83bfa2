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
        code=code_hash("track"),
        environment=ENVIRONMENT,
    message:
        "Track the markers in batch {wildcards.batch}"
    script:
        "../scripts/track.py"


rule picture:
    input:
        tables=TABLES,
        videos=[VIDEOS[name] for name in BATCHES.get("0000", ())],
        markers=OUT / "markers/0000.nc",
    output:
        picture=OUT / "picture.nc",
    log:
        OUT / "logs/picture.log",
    params:
        folder=CAMPAIGN,
        code=code_hash("picture"),
        environment=ENVIRONMENT,
    message:
        "Keep one frame, to show the markers on"
    script:
        "../scripts/picture.py"


rule tracking_quality:
    input:
        markers=expand(OUT / "markers/{batch}.nc", batch=BATCHES),
    output:
        tracking_quality=OUT / "tracking_quality.nc",
    log:
        OUT / "logs/tracking_quality.log",
    params:
        code=code_hash("tracking_quality"),
        environment=ENVIRONMENT,
    message:
        "Judge how well each trial was tracked"
    script:
        "../scripts/tracking_quality.py"


rule overlay:
    input:
        video=lambda wildcards: VIDEOS[wildcards.trial],
        markers=lambda wildcards: OUT / f"markers/{find_batch(wildcards.trial)}.nc",
    output:
        film=OUT / "overlays/{trial}.avi",
        sheet=OUT / "overlays/{trial}.jpg",
    log:
        OUT / "logs/overlay_{trial}.log",
    params:
        folder=CAMPAIGN,
        trial="{trial}",
        code=code_hash("overlay"),
        environment=ENVIRONMENT,
    message:
        "Draw the markers of {wildcards.trial} into its video"
    script:
        "../scripts/overlay.py"


rule overlays:
    input:
        expand(OUT / "overlays/{trial}.jpg", trial=VIDEOS),
