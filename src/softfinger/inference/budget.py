"""Numbers that limit the work of an inference."""

from dataclasses import dataclass


@dataclass(frozen=True)
class InferenceBudget:
    """How much is drawn, tried and tabulated."""

    steps: int = 60
    """Linearisations of a fit. Why: most rest after ten."""
    few_trials_steps: int = 100
    """The same over the number of trials, if more. Why: few trials are quick, and need more."""
    angle_error: float = 1e-5
    """[rad] that the forward model may err by. Why: a hundredth of a good camera's noise."""
    longest_step: tuple[float, ...] = (0.7, 0.7, 1.0, 0.5)
    """Longest steps of own parameters in a linearisation. Why: it is straight so far."""
    start_spread: tuple[float, ...] = (0.4, 0.6, 0.8, 0.02)
    """Spreads from which a fit starts. Why: twice the typical ones, so that trials are free."""
    start_parts: tuple[float, ...] = (1.0, 0.5, 0.25, 0.0)
    """Parts of a model file's effects from which a fit starts. Why: trials may not move with all.

    Test: `test_pose.py::test_a_repaired_model_starts_where_the_trials_have_a_motion`.
    """
    rest_share: float = 1e-4
    """Share of its gain a resting fit may lack. Why: the digits that are asked of it."""
    pace: int = 8
    """Last steps that show whether a fit still gains. Why: it may go round its rest."""
    recent: int = 3
    """Last steps whose best shows how fast it gains. Why: one may be short by chance.

    Test: `test_mixed_effects.py::test_a_fit_stops_where_it_will_not_reach_its_rival`.
    """
    least_fraction: float = 0.05
    """Of a step that is taken where changes overshoot. Why: less never arrives."""
    shortenings: int = 6
    """Regions that a step tries. Why: if a step of a hundredth does not gain, none does."""
    smaller: float = 3.0
    """Factor by which a region shrinks. Why: as `shortenings`."""
    larger: float = 2.0
    """Factor by which it grows where a step gained as expected. Why: it soon spans a valley."""
    largest_region: float = 2.0
    """Largest region [longest steps]. Why: with corrections it is straight so far."""
    agreed: float = 0.25
    """Share of the expected gain that needs no correction. Why: a linearisation costs as much."""
    poor: float = 0.1
    """Share of it below which the region was too large. Why: the next step would gain less."""
    edge: float = 0.8
    """Share of the region that a step at its edge has. Why: finding its edge is not the aim."""
    dampings: tuple[float, float] = (-16.0, 4.0)
    """Logarithms of the dampings that reach it, over the curvature. Why: rounding; no motion."""
    halvings: int = 14
    """Of the interval between them. Why: a step is then right to 1 %."""
    returns: int = 2
    """Gauss-Newton steps back to the bottom of the valley. Why: they converge in squares."""
    farthest_back: float = 0.75
    """Share of a step that one of them may go. Why: more has lost the valley."""
    omega_moves: int = 200
    """Trials up to which Ω adapts without one. Why: with more, it hardly does."""
    guess_rates: int = 25
    """Rates that a first guess tries. Why: the fit starts there, no more."""
    guess_trials: int = 15
    """Trials that it looks at. Why: as `guess_rates`."""
    curves: int = 96
    """Rates that span the step solution's table. Why: to 1e-10 of the largest."""
    table_step: float = 0.02
    """Of the log rate between entries. Why: as `curves`, by cubic interpolation."""
    slowest: float = 0.02
    """Lowest rate · duration in the table. Why: slower is a straight line."""
    fastest: float = 20.0
    """Highest rate · median interval in it. Why: faster is over before the first frame."""
    table_protocols: int = 12
    """Protocols from which the table is learnt. Why: others lie between."""
    profile_grid: int = 160
    """Rates at which a trial's likelihood is profiled. Why: no mode is missed."""
    profile_zoom: int = 5
    """Points on either side in a zoom. Why: each makes the grid five times finer."""
    profile_zooms: int = 9
    """Zooms. Why: to rounding."""
    simulated: int = 120_000
    """Trials that are moved to weigh draws. Why: it takes no longer than sampling."""
    measured: int = 20_000
    """Trials moved where weighing all would take longer. Why: an sd to 1 %."""
    together: int = 2_000
    """Trials in one call. Why: it bounds the memory."""
    jitter_bins: int = 40
    """Bins of a trial in which jitter counts. Why: those in which it moves fastest."""
    step_hats: int = 64
    """Hats over the gaps of a slow log, for all steps of a trial. Why: each is a simulation.

    Test: `test_step_scatter.py::test_a_load_that_always_moves_has_no_steps`.
    """
    gain_shapes: int = 5
    """Shapes of a gain's random walk. Why: the sixth has 1 % of its variance."""
    drift_shapes: int = 16
    """The same of a direction or an angle, at least. Why: the next has less than the noise.

    Test: `test_disturbances.py::test_a_camera_that_turns_moves_the_first_joint_alone`.
    """
    drift_columns: int = 60
    """Shapes of all trials and joints together, where few of them would have fewer.

    Why: one long trial shows what they leave; many share their physics, and need not.
    Test: `test_disturbances.py::test_a_long_drift_of_one_trial_leaves_nothing_that_lasts`.
    """
    lasting_shapes: int = 12
    """Slow waves of noise that lasts longer. Why: the next is seen in windows.

    Test: `test_disturbances.py::test_noise_that_outlasts_the_windows_is_no_drift`.
    """
    flicker_columns: int = 500
    """Waves of noise in each octave, of all trials and joints. Why: a minute at 240 Hz has so many.

    Test: `test_disturbances.py::test_noise_of_equal_power_in_each_octave_is_no_drift`.
    """
    octave: float = 6.0
    """Memories of the noise that such a wave must last. Why: shorter ones are noise of windows.

    Test: `test_disturbances.py::test_noise_of_equal_power_in_each_octave_is_no_drift`.
    """
    disturbed_trials: int = 100
    """Trials of a fit in which disturbances are sought. Why: what all suffer from, these show."""
    disturbance_rounds: int = 3
    """Rounds in which a model adapts to a disturbance. Why: the model is linearised."""
    dispersion: float = 2.0
    """Of the chains' starts, in posterior sds. Why: R-hat needs starts wider than the posterior."""
    first_step: float = 0.3
    """Of NUTS before tuning. Why: its units are those of the posterior."""
    gibbs_moves: tuple[float, ...] = (0.0, 0.92)
    """Autoregression of a trial's moves in a sweep. Why: one far, one that is accepted."""
    walk: float = 2.4
    """Of a random walk, in posterior sds over √p. Why: Gelman, Roberts, Gilks (1996)."""
    pairs: int = 4
    """Antithetic pairs that integrate a trial out. Why: 0.1 nats in a trial."""
    refits: int = 150
    """Trials in all refits together. Why: 12 of 12 trials, one of 100."""
    refit_chains: int = 2
    """Chains of a refit. Why: it is for the mean of one trial's likelihood."""
    refit_tune: int = 150
    """Draws of each that only tune it. Why: as `refit_chains`."""
    refit_draws: int = 200
    """Draws of each that count. Why: as `refit_chains`."""
    left_out_draws: int = 1000
    """Draws of the population without a trial. Why: quantiles of 5 % to a tenth of an sd."""
    pit_draws: int = 250
    """New trials behind a PIT. Why: its own error is 3 %, below a histogram's."""
    prior_draws: int = 1000
    """New trials of the prior. Why: a band's edge from fifty."""
    predicted_frames: int = 60
    """Frames of a predicted trial, evenly spaced. Why: what a figure shows."""
    predicted_protocols: int = 8
    """Load histories that the prior predicts. Why: what a figure shows."""


BUDGET = InferenceBudget()
