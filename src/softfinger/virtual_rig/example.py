"""The tiny campaign, committed under ``data/example``."""

from pathlib import Path

from softfinger.virtual_rig.campaign_folder import write_campaign_folder
from softfinger.virtual_rig.motion import draw_motion

EXAMPLE_SEED = 20260302
EXAMPLE_CONFIG = {
    "n_trials": 4,
    "level": "angles",
    "duration_s": 10.0,
    "fps": 10.0,
    "load_time_s": [0.0, 10.0],
    "load_tension_n": [8.0, 8.0],
    "wire_geometry": "constant_arm",
    "link_length_m": [0.025, 0.025, 0.025],
    "link_mass_kg": [0.005, 0.005, 0.005],
    "joint_length_m": 0.008,
    "wire_offset_m": 0.005,
    "trial_interval_s": 120.0,
    "metres_per_pixel": 0.000235,
    "marker_diameter_m": 0.004,
    "marker_contrast_grey": 130.0,
    "blur_px": 0.6,
    "light_unevenness": 0.25,
    "camera_noise_grey": 3.0,
    "video_quality": 90,
    "angle_noise_sd_rad": 0.003,
    "angle_noise_autocorrelation": 0.3,
}


def write_example_campaign(folder: Path) -> None:
    """Write the example campaign.

    It has angles of four trials of 10 s at 10 Hz. Its bytes are always the same.
    """
    truth = draw_motion(EXAMPLE_CONFIG, EXAMPLE_SEED)
    write_campaign_folder(truth, EXAMPLE_CONFIG, folder, EXAMPLE_SEED)
