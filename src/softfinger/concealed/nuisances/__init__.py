"""The nuisances of the proof."""

from softfinger.concealed.nuisances import (
    camera_drift,
    clock_rate,
    held_frames,
    hum,
    laplace_population,
    load_cell_drift,
    lost_frames,
    noisy_load,
    other_day,
    outliers,
    quantised_angles,
    sampled_log,
    signal_noise,
    student_noise,
    swimming_marker,
    timing_jitter,
    uneven_noise,
)
from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Scene

NUISANCES: dict[str, Nuisance] = {
    module.NUISANCE.id: module.NUISANCE
    for module in (
        outliers,
        uneven_noise,
        signal_noise,
        timing_jitter,
        noisy_load,
        lost_frames,
        held_frames,
        quantised_angles,
        student_noise,
        hum,
        camera_drift,
        load_cell_drift,
        clock_rate,
        swimming_marker,
        laplace_population,
        other_day,
        sampled_log,
    )
}
# Findings that a kind of noise gives rise to by itself.
OF_NOISE = {
    "heavy_tailed": ("heavy_tails", "outliers"),
    "gappy": ("lost_frames",),
    "uneven": ("lost_frames", "timing_jitter"),
}

__all__ = ["NUISANCES", "OF_NOISE", "Fault", "Mark", "Nuisance", "Scene"]
