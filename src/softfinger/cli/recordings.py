"""Verbs from the rig to joint angles.

`virtual-rig`, `track`, `calibrate` and `angles`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from softfinger.campaign import list_tables, read_campaign
from softfinger.cli.application import (
    STEPS,
    CampaignFolder,
    ConfigFile,
    Out,
    PhysicsFile,
    app,
    choose_model,
    show_example,
)
from softfinger.config import read_config
from softfinger.faults import Fault
from softfinger.stages.keys import choose_settings


@app.command(rich_help_panel=STEPS, epilog=show_example("softfinger virtual-rig --out simulated"))
def virtual_rig(
    out: Out,
    config: ConfigFile = None,
    model: PhysicsFile = None,
    example: Annotated[
        bool, typer.Option("--example", help="Write the small example campaign, and nothing else.")
    ] = False,
) -> None:
    """Draw, move and film a finger.

    Writes OUT/campaign, and the truth beside it.
    """
    if example:
        from softfinger.virtual_rig.example import write_example_campaign

        if (out / "campaign.yaml").exists():
            raise Fault(f"{out}: contains a campaign already; choose another folder")
        write_example_campaign(out)
        return
    from softfinger.stages.film import film
    from softfinger.stages.virtual_rig import virtual_rig
    from softfinger.virtual_rig.population import build_trial_names

    settings = read_config(config)
    knobs, seed = choose_settings(settings, "virtual_rig"), settings["seed"]
    folder, truth = out / "campaign", out / "truth.nc"
    physics = choose_model(settings, model)
    virtual_rig(truth=truth, folder=folder, config=knobs, seed=seed, model=physics)
    if knobs["level"] == "video":
        names = build_trial_names(knobs["n_trials"])
        videos = [folder / f"video/{name}.avi" for name in names]
        knobs = choose_settings(settings, "film")
        film(truth=truth, videos=videos, config=knobs, seed=seed)


@app.command(
    rich_help_panel=STEPS,
    epilog=show_example("softfinger track my_campaign --out my_results --overlays"),
)
def track(
    campaign: CampaignFolder,
    out: Out,
    config: ConfigFile = None,
    overlays: Annotated[
        bool, typer.Option("--overlays", help="Write OUT/overlays: what was found, in the videos.")
    ] = False,
) -> None:
    """Follow the markers through every video.

    Writes OUT/markers/*.nc, and how well it went.
    """
    from softfinger.stages.overlay import overlay
    from softfinger.stages.picture import picture
    from softfinger.stages.prepare import batch_filmed, track_campaign
    from softfinger.stages.tracking_quality import tracking_quality

    settings, described = read_config(config), read_campaign(campaign)
    batches = batch_filmed(described, settings["trials_per_job"])
    if not batches:
        raise Fault(f"{campaign}: no trial has a video, so there is nothing to track")
    files = track_campaign(campaign, out, settings)
    picture(
        folder=campaign,
        tables=list_tables(described),
        videos=[trial.recording for trial in batches[0]],
        markers=files[0],
        picture=out / "picture.nc",
    )
    tracking_quality(markers=files, tracking_quality=out / "tracking_quality.nc")
    if not overlays:
        return
    for markers, trials in zip(files, batches, strict=True):
        for trial in trials:
            overlay(
                folder=campaign,
                trial=trial.name,
                video=trial.recording,
                markers=markers,
                film=out / f"overlays/{trial.name}.avi",
                sheet=out / f"overlays/{trial.name}.jpg",
            )


@app.command(
    rich_help_panel=STEPS,
    epilog=show_example("softfinger calibrate pictures --columns 9 --rows 6 --square-m 0.010"),
)
def calibrate(
    pictures: Annotated[Path, typer.Argument(help="Folder of pictures of the board.")],
    columns: Annotated[int, typer.Option(help="Squares side by side.", min=3)],
    rows: Annotated[int, typer.Option(help="Squares on top of each other.", min=3)],
    square_m: Annotated[float, typer.Option(help="Side of a square [m].")],
    marker_m: Annotated[
        float | None, typer.Option(help="Side of the coded markers [m]: a ChArUco board.")
    ] = None,
    dictionary: Annotated[str, typer.Option(help="Of the coded markers.")] = "DICT_4X4_50",
) -> None:
    """Find a camera's intrinsics from pictures.

    The pictures show a chessboard or a ChArUco board.

    Prints the lines that belong under `camera:` in campaign.yaml.
    """
    from softfinger.tracking.calibration import Board, calibrate_camera

    kind = "chessboard" if marker_m is None else "charuco"
    if not pictures.is_dir():
        raise Fault(f"{pictures}: not a folder; expected one with pictures of the board")
    board = Board(kind, columns, rows, square_m, marker_m, dictionary)
    found = calibrate_camera(sorted(p for p in pictures.iterdir() if p.is_file()), board)
    for name, reason in found.set_aside.items():
        typer.echo(f"set aside {name}: {reason}", err=True)
    sd = " and ".join(f"{value:.2g}" for value in found.focal_sd)
    typer.echo(f"corners deviate {found.rms:.3g} px rms; focal lengths known to {sd} px", err=True)
    typer.echo(found.to_yaml(), nl=False)


@app.command(
    rich_help_panel=STEPS, epilog=show_example("softfinger angles my_campaign --out my_results")
)
def angles(campaign: CampaignFolder, out: Out, config: ConfigFile = None) -> None:
    """Gather joint angles and loads of all trials.

    Writes OUT/angles.nc (after `track`, if filmed).

    What looks wrong in them is OUT/doubts.nc.
    """
    from softfinger.stages.angles import angles
    from softfinger.stages.doubt import doubt

    angles(
        folder=campaign,
        tables=list_tables(read_campaign(campaign)),
        markers=sorted((out / "markers").glob("*.nc")),
        angles=out / "angles.nc",
        config=choose_settings(read_config(config), "angles"),
    )
    doubt(angles=out / "angles.nc", doubts=out / "doubts.nc")
