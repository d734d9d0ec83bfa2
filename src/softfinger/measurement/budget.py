"""Numbers that limit the work of a measurement.

They also set the accuracy of its sums.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class MeasurementBudget:
    """How much is tried, and how finely."""

    evaluations: int = 60
    """Evaluations that refine the sizes of components. Why: sizes to 3 %."""
    memory_evaluations: int = 80
    """Evaluations that refine a white share of the noise. Why: the share to 2 %."""
    memory_rows: int = 10_000
    """Quiet frames of a joint that show how long its noise lasts. Why: ρ to a percent.

    Test: `test_noise.py::test_some_windows_of_a_long_recording_show_its_memory`.
    """
    scale_rounds: int = 3
    """Rounds in which the noise of trials is scaled. Why: the third changes it by 1 %.

    Test: `test_measure.py::test_noise_that_grows_with_the_deflection`.
    """
    rounds: int = 10
    """Rounds in which peaks are taken for outliers. Why: a burst of ten frames goes in five."""
    size_digits: float = 0.01
    """Step of a component's log size that shows a slope. Why: its sd is larger."""
    held_rounds: int = 50
    """Rounds in which the share of held frames is found. Why: it converges by halves."""
    bin_growth: float = 0.12
    """Width of a bin over the time since load change. Why: creep bends little in it."""
    bin_share: float = 1.0 / 80.0
    """Largest width of a bin over the trial's length. Why: as `bin_growth`, late in it."""
    bin_gap: float = 2.5
    """[median intervals] Gap that ends a bin. Why: a lost frame does not, two do."""
    distinct_gaps: int = 6
    """Different gaps that are kept as they are. Why: as many as interpolation needs nodes."""
    gap_nodes: int = 8
    """Nodes on which more gaps are spread. Why: 1e-4 of what noise does between them.

    Test: `test_gaps.py::test_many_gaps_are_interpolated`.
    """


BUDGET = MeasurementBudget()
