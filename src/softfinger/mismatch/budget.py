"""Numbers that limit the work of a diagnosis."""

from dataclasses import dataclass


@dataclass(frozen=True)
class DiagnosisBudget:
    """How much a diagnosis tries."""

    first_steps: int = 4
    """Linearisations before candidates are compared. Why: by then the order is settled."""
    leading: int = 4
    """Effects whose best form is always fitted. Why: scores are linear.

    Test: `test_rank.py::test_only_leading_effects_are_fitted_where_none_comes_near_what_is_asked`.
    """
    near_nats: float = 2.0
    """[nats] behind the best gain that is fitted. Why: what a linear score errs by."""
    near_share: float = 0.7
    """The same as a share of the best gain. Why: far from zero a linear score errs by that much."""
    reach_nats: float = 20.0
    """[nats] behind the best fit that goes on. Why: what `first_steps` may lack."""
    reach_share: float = 0.5
    """The same as a share of the best gain. Why: as `near_share`, after some steps."""
    alike: int = 2
    """Forms of the same effects that go on though another one is clearly ahead.

    Why: a second one may leave more room for a further effect.
    Test: `test_rank.py::test_only_two_forms_of_the_same_effects_go_on_far_behind_the_best`.
    """
    resize_nats: float = 0.5
    """[nats] that another size of a law gains, where it is fitted anew. Why: that costs a second.

    Test: `test_law_size.py::test_a_slight_law_has_a_small_size`.
    """
    hopeless_nats: float = -2.0
    """[nats] No form with a lower linearised gain is fitted. Why: its prior alone costs that."""
    most_effects: int = 3
    """Effects in a set that is tried. Why: where a third is needed none is named."""
    beyond: int = 2
    """Effects added to the best set where none is named. Why: so that most of the rest is shared.

    Test: `test_beyond.py::test_further_effects_are_explained_and_not_named`.
    """
    rivals: int = 2
    """Sets of effects from which a further effect is tried. Why: forward addition with a second."""
    forms: int = 3
    """Forms of an effect that are tried in pairs. Why: they hide alike."""
    pairs: int = 4
    """Pairs of effects that are fitted. Why: pairs' scores are of pairs, and in order."""
    far_nats: float = 300.0
    """[nats] that one effect gains where pairs, and forms with far starts, are fitted whatever
    their linear score, and from far starts too.

    Why: the angles then miss by more than a linear model is good for.
    Test: `test_leading_pairs.py::test_pairs_are_fitted_where_much_is_left_out`,
    `test_rank.py::test_a_slow_lag_is_found_where_the_joint_took_its_part`,
    `test_rank.py::test_play_is_found_in_each_joint_though_the_damper_took_its_part`.
    """
    leading_pairs: int = 4
    """Effects of which such pairs are made. Why: three that delay the motion look alike, and what
    acts beside one of them comes after them."""
    leading_forms: int = 2
    """Forms of each of them. Why: another form may lead to another mode."""
    paired: int = 12
    """Pairs of effects to which a third is added. Why: a triple's best pair is among the first."""
    leaders: int = 2
    """Effects judged with their own measurement before the search."""
    finalists: int = 6
    """Sets of effects that are judged so after it. Why: the sixth is out of all competition."""
    no_motion_nats: float = 1e12
    """Loss of a log or clock under which a model has no motion. Why: finite, for a parabola."""
    step_digits: float = 2e-3
    """Of a gap of the load's log, to which a step is placed. Why: a tenth of a millisecond."""
    step_share: float = 0.05
    """Of a gap of the load's log, by which steps are moved first.

    Why: where that explains less, so does more; a search to the end takes many fits.
    Test: `test_weigh_log.py::test_steps_that_came_at_their_rows_are_left_there_by_one_fit`.
    """
    placed_steps: int = 12
    """Steps of a trial that are each placed. Why: each takes a simulation at every place.
    Test: `test_weigh_log.py::test_more_steps_than_can_be_placed_are_open`.
    """
    step_tries: int = 9
    """Places of a step in its gap that are tried. Why: a parabola gives the rest."""
    step_rounds: int = 6
    """Times that all steps are placed anew. Why: a motion just begun shows its first millisecond.

    Test: `test_weigh_log.py::test_a_step_in_a_wide_gap_is_placed_to_a_hundredth_of_it`.
    """
    step_zoom: float = 0.5
    """Width of the places that are tried, of that in the round before.

    Why: four of the tries before are within it, so a step that was misplaced by one comes back.
    """
    rest_nats: float = 0.02
    """[nats] at which a finalist's fit rests. Why: far below any decision's size."""
    shape_steps: int = 25
    """Linearisations of a free-form term. Why: it starts where the model is already fitted."""
    shape_points: int = 41
    """Places at which a spline is tabulated. Why: four to a knot, and both ends."""
    frequencies: int = 900
    """Frequencies at which waves are sought. Why: two a resolution element in a 30 s trial."""
    hums: int = 9
    """Hums that are sought, one after the other. Why: three harmonics in each of three joints."""
    hum_tries: int = 17
    """Frequencies about the best of a grid. Why: an eighth of a step, for trials of minutes."""
    ring_frequencies: int = 8
    """Frequencies at which a load drives oscillators. Why: short-lived ones respond to all."""
    offset_frames: float = 4.0
    """Frames by which a trial's clock is moved at a time. Why: a buffer of a camera has so many."""
    offset_tries: int = 33
    """Offsets that are tried. Why: quarters of a frame; a parabola gives the rest."""
    offset_rounds: int = 3
    """Times that a model is fitted to clocks that were moved. Why: it then has come to rest."""
    offset_rivals: int = 3
    """Pairs of effects that compete with clocks that were moved.

    Why: the best of them by far where there are two effects.
    Test: `test_mend_offsets.py::test_a_second_effect_is_no_offset`.
    """
    replicates: int = 20
    """Replicates drawn together. Why: it bounds the memory.
    Test: `test_calibrate.py::test_as_many_replicates_are_drawn_as_are_asked_for`.
    """
    folds: int = 5
    """Parts into which trials are left out. Why: the usual number."""
    draws: int = 99
    """New trials behind a band. Why: ranks in hundredths."""
    refit_steps: int = 8
    """Linearisations of a fit without a load level. Why: it starts at the mode of all."""
    levels: int = 6
    """Load levels that are left out, evenly chosen. Why: what a figure has room for."""
    resamples: int = 400
    """Draws of trials behind the bounds of a coverage. Why: 5 % quantiles from twenty each."""
    quantile_points: int = 1000
    """Points of a normal posterior, for reported functions. Why: 0.1 % each."""
    explained: int = 5
    """Sets of effects whose share a verdict lists. Why: further ones are far behind.

    Test: `test_explained.py::test_the_best_set_of_the_search_comes_first`.
    """
    chains: int = 4
    """Chains that sample the repaired model. Why: R-hat needs several."""
    tune: int = 300
    """Draws of each that only tune it. Why: the expansion whitens the posterior."""
    kept_draws: int = 500
    """Draws of each that count. Why: with fewer, R-hat is above 1.01 by chance."""
    cores: int = 2
    """Chains at a time. Why: the draws are the same whatever it is."""
    target_accept: float = 0.8
    """Share of accepted steps that tuning seeks. Why: a whitened posterior is nearly normal."""
    survivors: int = 5
    """Models that a plan tells apart. Why: a sixth has a few percent at most."""
    first_places: int = 4
    """Places of each kind of protocol that are tried. Why: the best is then improved."""
    leading_shapes: int = 2
    """Kinds of protocol that are improved. Why: the third was behind from the start."""
    simplex_tries: int = 24
    """Protocols that each improvement tries. Why: a plan within a minute."""
    angle_rounds: int = 5
    """Times that a load is lowered to hold the angle. Why: angles follow loads nearly."""
    sure_draws: int = 300
    """Campaigns drawn for the probability of a sure answer. Why: it is known to 3 %."""
    safety_draws: int = 8
    """Times that all trials are drawn to check angles. Why: hundreds of fingers in all."""
    knots: int = 500
    """Knots of a load history, at most. Why: a controller stores 512."""
    stairs: int = 6
    """Levels of a staircase. Why: up and down twice."""
    levels_planned: int = 4
    """Levels of load, one for each history. Why: a law's curve needs them."""
    fastest_cycles: float = 20.0
    """Cycles of a load in a trial, at most. Why: a rig stores 512 knots."""
    cycle_knots: int = 16
    """Knots in a cycle. Why: chords leave the sine by 2 % of its amplitude."""
    max_depth: int = 10
    """Doublings of a trajectory. Why: a whitened posterior needs three."""


BUDGET = DiagnosisBudget()
