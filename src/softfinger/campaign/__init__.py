"""The campaign folder: one finger, many trials.

A specimen may replace the finger. The folder is read and validated, and every fault is listed.
"""

from softfinger.campaign.camera import Camera, Intrinsics
from softfinger.campaign.description import DeclaredFinger
from softfinger.campaign.folder import Campaign, check_campaign, list_tables, read_campaign
from softfinger.campaign.load_log import read_load
from softfinger.campaign.recordings import marker_names, read_angle_table, read_marker_table
from softfinger.campaign.specimen import Specimen
from softfinger.campaign.trials import Trial

__all__ = [
    "Camera",
    "Campaign",
    "DeclaredFinger",
    "Intrinsics",
    "Specimen",
    "Trial",
    "check_campaign",
    "list_tables",
    "marker_names",
    "read_angle_table",
    "read_campaign",
    "read_load",
    "read_marker_table",
]
