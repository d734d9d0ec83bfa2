"""Verb `check`: what is set aside, or doubtful."""

from dataclasses import replace
from pathlib import Path

from softfinger.campaign import Campaign, check_campaign, read_campaign
from softfinger.doubts import Doubt, doubt_camera, doubt_files, find_doubts
from softfinger.tracking import assemble_angles


def check(folder: Path) -> tuple[Campaign, dict[str, str], list[Doubt]]:
    """Read everything of a campaign but its videos.

    Returns
    -------
    reasons
        Trial → why it would be set aside.
    doubts
        What looks wrong in the others.

    Raises
    ------
    CampaignFault
        The campaign cannot be used at all.
    """
    campaign = read_campaign(folder)
    filmed = [trial for trial in campaign.trials if trial.level == "video"]
    tabled = tuple(trial for trial in campaign.trials if trial.level != "video")
    reasons, doubts = dict(campaign.set_aside), []
    if filmed:
        reasons |= check_campaign(folder)
        if campaign.camera is not None and campaign.camera.marker_diameter_m is not None:
            camera, length = campaign.camera, campaign.finger.link_length_m
            doubts += doubt_camera(
                camera.fps, camera.metres_per_pixel, camera.marker_diameter_m, length
            )
    doubts += doubt_files({trial.name: trial.recording for trial in campaign.trials})
    if tabled:
        angles = assemble_angles(replace(campaign, trials=tabled), [], covariance=False)
        aside = angles["set_aside_trial"].values.astype(str).tolist()
        reasons |= dict(zip(aside, angles["set_aside_reason"].values.astype(str), strict=True))
        doubts += find_doubts(angles)
    return campaign, reasons, doubts
