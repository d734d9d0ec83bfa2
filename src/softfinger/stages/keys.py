"""Which keys each stage reads, hence its reruns."""

from collections.abc import Mapping
from typing import Any

SCENE = ("fps", "link_length_m", "joint_length_m", "metres_per_pixel", "marker_diameter_m")
SPREAD = ("draws", "sampled_draws", "draw_samples", "c_p_truncation_sd")

KEYS: dict[str, tuple[str, tuple[str, ...]]] = {
    "virtual_rig": (
        "virtual_rig",
        (
            *SCENE,
            "n_trials",
            "level",
            "duration_s",
            "load_time_s",
            "load_tension_n",
            "wire_geometry",
            "link_mass_kg",
            "wire_offset_m",
            "trial_interval_s",
            "angle_noise_sd_rad",
            "angle_noise_autocorrelation",
        ),
    ),
    "film": (
        "virtual_rig",
        (
            *SCENE,
            "marker_contrast_grey",
            "blur_px",
            "light_unevenness",
            "camera_noise_grey",
            "video_quality",
        ),
    ),
    "assumptions": (
        "virtual_rig",
        (
            "link_length_m",
            "link_mass_kg",
            "joint_length_m",
            "wire_offset_m",
            "load_tension_n",
            "fps",
        ),
    ),
    "angles": ("tracking", ("smallest_share_seen", "largest_rigid_residual_px", "largest_sd_px")),
    "least_squares": ("estimation", ("outlier_rule", "outlier_cutoff")),
    "fit": (
        "estimation",
        (
            "covariance",
            "sampler",
            "chains",
            "tune",
            "draws",
            "target_accept",
            "max_depth",
            "predictive_draws",
        ),
    ),
    "sampling": ("estimation", ("r_hat_max", "ess_min", "divergences_max")),
    "propagate": (
        "propagation",
        (*SPREAD, "band_samples", "band_times", "density_times_s", "density_angles"),
    ),
    "sobol": ("propagation", (*SPREAD, "sobol_time_step_s", "running_times_s")),
    "shapley": ("propagation", (*SPREAD, "sobol_time_step_s")),
    "summarise": (
        "report",
        ("ci_prob", "pareto_k_max", "shared_residual_max", "coverage_tolerance"),
    ),
    "diagnose": (
        "mismatch",
        ("bootstrap_replicates", "false_alarm_probability", "sample_repaired", "longest_search_s"),
    ),
}
"""Stage → block of the configuration, and the keys of it."""


def choose_settings(config: Mapping[str, Any], stage: str) -> dict[str, Any]:
    """Choose what a stage reads of the whole configuration.

    >>> choose_settings({"tracking": {}, "estimation": dict.fromkeys(KEYS["sampling"][1], 1)},
    ...     "sampling")
    {'r_hat_max': 1, 'ess_min': 1, 'divergences_max': 1}
    """
    block, keys = KEYS[stage]
    return {key: config[block][key] for key in keys}
