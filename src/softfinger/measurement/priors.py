"""What a measurement assumes of noise: model assumptions."""

from dataclasses import dataclass


@dataclass(frozen=True)
class MeasurementPriors:
    """Prior sizes of what the noise may have.

    Each of a grid is as likely.
    """

    freedoms: tuple[float, ...] = (3.0, 4.0, 6.0, 10.0, 20.0)
    """Degrees of freedom of heavy tails. Why: from hardly a variance to hardly a tail."""
    uneven_sizes: tuple[float, ...] = (0.05, 0.1, 0.2, 0.4, 0.8)
    """Sds of the log noise sd over trials or cells. Why: 5 % up to a factor of two."""
    signal_sizes: tuple[float, ...] = (0.3, 0.6, 1.2, 2.5, 5.0)
    """Growth of the noise at the largest deflection. Why: hardly seen up to five times."""
    window_scatter: tuple[float, ...] = (0.0, 0.05, 0.1, 0.2, 0.4)
    """Sds of a window's log variance beyond chance. Why: light and motion differ a little."""
    declared_sd: float = 0.1
    """Sd of the log noise sd about the declared. Why: nobody knows it to 1 %.

    Test: `test_measure.py::test_a_declared_sd_is_expected_and_not_enforced`.
    """
    degree: int = 4
    """Of the polynomial that motion follows in a quiet window. Why: creep has settled there."""
    lasting_windows: float = 0.25
    """Mean of how long noise lasts, in windows. Why: what lasts longer is a drift to a window.

    Test: `test_noise.py::test_noise_that_outlasts_the_windows_is_not_taken_for_an_endless_drift`.
    """
    white_shares: tuple[float, ...] = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 0.6)
    """Shares of the noise that are tried as white. Why: each a third of the next, up to most.

    Beside noise that lasts long a hundredth is most of what differs from frame to frame.
    Test: `test_noise.py::test_noise_of_two_kinds_is_told_from_one`,
    `test_noise.py::test_slight_white_noise_is_seen_beside_what_lasts`.
    """
    beyond: float = 2.0
    """How far a size may lie beyond those that are tried. Why: half a step of their grids."""
    longest_memory: float = 0.9995
    """ρ of the longest noise beside a white share. Why: it lasts ten windows.

    Test: `test_noise.py::test_noise_of_two_kinds_is_told_from_one`.
    """


PRIORS = MeasurementPriors()
