"""What a diagnosis assumes of what it seeks."""

from dataclasses import dataclass


@dataclass(frozen=True)
class DiagnosisPriors:
    """Prior probabilities and sizes."""

    base: float = 0.5
    """Probability of the base model. Why: neither side is favoured.

    Test: `test_settle.py::test_base_and_effects_share_the_prior_by_halves`.
    """
    listed: float = 0.6
    """Probability that effects are real where more are needed than are named.

    Why: more likely than not, as each explains a part. Test: as of `most_named`.
    """
    component_nats: float = 3.0
    """[nats] that a disturbance costs. Why: its size is one of five; one campaign in four has it.

    Test: `test_decisions.py::test_a_disturbance_costs_its_prior`.
    """
    noise_memory_sd: float = 0.03
    """Sd of the correlation of neighbouring bins that whitening leaves. Why: no noise is AR(1).

    Test: `test_decisions.py::test_noise_of_another_size_is_no_excess_and_what_lasts_is`.
    """
    step_mean: float = 0.5
    """Mean share of its gap by which a step of the load comes sooner. Why: any is as likely.

    Test: `test_weigh_log.py::test_steps_that_come_at_any_moment_of_their_gaps_are_each_placed`.
    """
    step_variance: float = 1.0 / 12.0
    """Variance of that share. Why: as of `step_mean`. Test: as of `step_mean`."""
    law_sizes: tuple[float, ...] = (1.0, 0.25, 0.0625)
    """Prior sizes of a free law that are as likely, over its form's. Why: half an arm to 3 % of it.

    Test: `test_law_size.py::test_a_slight_law_has_a_small_size`.
    """
    knots: int = 9
    """Coefficients of a cubic spline. Why: it turns up to eight times, more than any law."""
    shape_sizes_rad: tuple[float, ...] = (0.001, 0.004, 0.016, 0.064)
    """[rad] Sds of a spline's coefficients that are as likely. Why: noise of a good camera up."""
    shape_sizes_log: tuple[float, ...] = (0.1, 0.3, 1.0)
    """The same, of log parameters between trials. Why: 10 % up to a factor of 3."""
    slip_sizes_rad: tuple[float, ...] = (0.003, 0.01, 0.03)
    """[rad] Sds of a slip that are as likely. Why: a marker's edge up to its width."""
    slip_shares: tuple[float, ...] = (0.02, 0.1, 0.3, 0.6, 0.95)
    """Equally likely shares of trials that slip. Why: one in fifty up to nearly all."""
    hum_sizes: tuple[float, ...] = (0.03, 0.1, 0.3, 1.0, 3.0)
    """Equally likely sds of a hum over noise's. Why: hardly seen up to plain."""
    ring_periods: tuple[float, ...] = (1.0, 3.0, 10.0, 30.0)
    """Equally likely periods a ring decays in. Why: a soft finger up to a bell."""
    wave_sizes: tuple[float, ...] = (0.1, 0.3, 1.0, 3.0, 10.0, 100.0)
    """Equally likely powers of a wave over noise's. Why: half decades."""

    least_load: float = 0.2
    """Share of the largest load that a plan pulls at least. Why: less hides in the noise."""
    rest_s: float = 60.0
    """[s] between trials where no clock was logged. Why: the usual one."""
    limit_relaxed: int = 3
    """Factor on a limit that may be in the way. Why: what another rig can do."""
    camera_relaxed: int = 10
    """The same of the frame rate. Why: a high-speed camera; a lag and a delay differ in ms."""


PRIORS = DiagnosisPriors()
