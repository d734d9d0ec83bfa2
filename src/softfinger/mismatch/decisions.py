"""Numbers that change a verdict or a finding.

The user's own are in the configuration: `bootstrap_replicates`, `false_alarm_probability`. The
rest are rules of thumb: each one here would be needless if the model had a size for what it judges.
"""

from dataclasses import dataclass
from math import log


@dataclass(frozen=True)
class DiagnosisDecisions:
    """What a diagnosis decides by."""

    sure: float = 0.95
    """Probability from which a set of effects is named.

    It is the posterior one; below, sets are ambiguous.

    Why: the usual level of a claim.
    Test: `test_settle.py::test_strong_evidence_names_one_set_and_close_evidence_does_not`.
    """
    most_named: int = 2
    """Effects that a verdict names together at most.

    Why: where three are needed, something that no effect is, and they imitate, is as likely.
    Test: `test_conclude.py::test_three_effects_that_are_needed_are_no_name`.
    """
    slight: float = 0.02
    """Share of gain likely sets may disagree about.

    Then what they share is named.

    Why: forms are textbook forms, and err by a few percent; free laws make it smaller.
    Test: `test_settle.py::test_what_close_sets_share_is_settled_where_they_add_hardly_anything`.
    """
    rival_nats: float = 10.0
    """[nats] behind the best model that still compete.

    `rival_share` may be more.

    Why: odds of 20 000. Test: `test_decisions.py::test_models_compete_within_nats_or_a_share`.
    """
    rival_share: float = 0.15
    """The same, as a share of the best gain.

    Why: no recording has the textbook form, so where the evidence is large any spline gains more.
    Test: `test_stepwise.py::test_a_shape_alone_that_says_clearly_more_takes_the_place_of_effects`.
    """
    common_errors: float = 3.0
    """Standard errors beyond which clocks that differ between trials have a mean.

    What they have in common is then a delay, and no chance of their offsets.

    Why: as improbable as a first effect. Test: `test_mend_offsets.py::test_a_mean_by_chance_stays`.
    """
    form_error: float = 0.005
    """Share that textbook forms may leave to others.

    It is of what effects explain, and may go to a further effect, whichever that is, or to the
    noise of a load log.

    Why: a curve known to 7 % leaves (7 %)² of χ²; a free law has no such error.
    Test: `test_rank.py::test_a_further_effect_must_bring_more_than_errors_of_textbook_forms`,
    `test_settle.py::test_a_lead_within_the_error_of_shared_textbook_forms_is_none`,
    `test_weigh_log.py::test_a_log_takes_no_more_than_the_best_effect_may_leave`.
    """
    shape_left: float = 0.05
    """Share that effects may leave.

    It is of what they explain, and may go to a shape, a line or slips.

    Why: with more left, a curve is known to worse than 22 %; free laws leave far less.
    Test: `test_stepwise.py::test_what_effects_may_leave_grows_with_what_they_explain`.
    """
    least_left: float = log(1000.0)
    """[nats] that may always be left.

    Why: ten terms without an effect exceed it by chance in 1 % of campaigns.
    Test: `test_stepwise.py::test_what_effects_may_leave_grows_with_what_they_explain`.
    """
    missing: float = 1e-3
    """p-value below which something is missing.

    It is that of what lasts within trials.

    Why: one campaign in a thousand.
    Test: `test_settle.py::test_effects_that_leave_much_do_not_explain`.
    """
    tail_share: float = 0.2
    """Share of replicates from which the tail is learnt.

    The tail is that of the largest gain; the replicates are the bootstrap's.

    Why: forty of 199, so that the threshold is known to a sixth; an exponential tail needs a start
    well beyond the median. Test: `test_settle.py::test_threshold_and_p_value_of_chance_agree`.
    """
    joint_sd: float = 3.0
    """Posterior sds off zero that list a joint.

    It is the joint's spline that is off zero.

    Why: 0.3 % by chance at one place.
    Test: `test_decisions.py::test_a_joint_is_listed_where_its_spline_is_clearly_off_zero`.
    """
    turns_back: float = 0.5
    """Share of its fall that a softening may rise again.

    Why: heat that spreads, or water that dries, takes back some of it; with more, it is a law of
    rest or of the direction of motion. Test: `test_turned.py::test_half_of_a_fall_may_come_back`.
    """
    slip_nats: float = 5.0
    """Evidence [nats] from which a trial's slip is listed.

    Why: odds of 150, in a campaign of 40 trials.
    Test: `test_slips.py::test_a_slip_in_two_trials_is_found_there`.
    """
    false_discoveries: float = 0.05
    """False-discovery rate of a misfit's cells.

    Why: the usual one (Benjamini and Hochberg).
    Test: `test_decisions.py::test_a_misfit_is_located_where_false_discoveries_are_few`.
    """
    likely: float = 0.5
    """Probability that makes an effect part of the unlisted.

    Why: more likely than not.
    Test: `test_decisions.py::test_of_what_is_unlisted_likely_parts_are_stated`.
    """
    contradicts: float = 2.0
    """Ratio of noise sds that warns the user.

    It is the shown sd over the declared one.

    Why: compression and lens blur change it less.
    Test: `test_sufferings.py::test_a_declared_sd_that_the_recordings_contradict_is_doubted`.
    """
    other_noise: float = 1.5
    """Ratio from which a trial's noise is named.

    It is over the campaign's noise, or its inverse.

    Why: it halves or doubles the trial's weight.
    Test: `test_sufferings.py::test_the_trials_that_suffer_are_named`.
    """
    shows: float = 15.0
    """Expected gain [nats] that shows an effect.

    The gain is that of a protocol.

    Why: twice what chance reaches, since the strength is a guess.
    Test: `test_decisions.py::test_no_protocol_is_proposed_that_shows_too_little`.
    """
    strength: float = 2.0
    """Strength of effects in tables, in prior sds.

    At it, tables state whether an effect could show.

    Why: a strong effect that is still plausible; one that is hidden then is not testable.
    Test: `test_masking.py::test_a_law_of_flow_vanishes_under_one_load_and_not_under_several`.
    """
    design_trials: int = 12
    """Trials of an experiment that is proposed.

    Why: a morning's work at the rig.
    Test: `test_decisions.py::test_an_experiment_is_of_a_dozen_trials`.
    """
    windows_s: tuple[float, ...] = (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, float("inf"))
    """Edges [s] of the cells that locate a misfit.

    They count from a change of load.

    Why: half decades, from a frame to a recording.
    Test: `test_decisions.py::test_cells_of_few_numbers_are_not_judged`.
    """
    loading: float = 0.2
    """Change in a trial from which the load moves.

    As a share of the largest load.

    Why: a hold that drifts less is a hold. Test: `test_decisions.py::test_phases_follow_the_load`.
    """
    at_rest: float = 0.05
    """Share of the largest load of a resting finger.

    Why: a load cell's zero. Test: `test_decisions.py::test_phases_follow_the_load`.
    """
    least_count: int = 8
    """Whitened residuals from which a cell is judged.

    Why: the mean of fewer is not normal.
    Test: `test_decisions.py::test_cells_of_few_numbers_are_not_judged`.
    """
    least_trials: int = 6
    """Trials from which a covariate is tested.

    They are those in which it is known.

    Why: five ranks reach no p-value below 1 %.
    Test: `test_decisions.py::test_a_covariate_of_few_trials_is_not_tested`.
    """
    least_values: int = 4
    """Different arguments from which a spline is tried.

    Why: three are a parabola. Test: `test_decisions.py::test_a_spline_needs_values_to_go_through`.
    """
    slip_frames: int = 10
    """Quiet frames from which a trial's slips are sought, and frames on either side of one.

    Why: before and after a step, some must be left; fewer may be a burst of gross errors.
    Test: `test_slips.py::test_a_few_frames_at_the_end_are_no_slip`.
    Test: `test_decisions.py::test_short_trials_are_not_searched_for_slips_or_waves`.
    """
    wave_frames: int = 24
    """Used frames from which a trial's wave is sought.

    Why: its mean and its scale are taken off first.
    Test: `test_decisions.py::test_short_trials_are_not_searched_for_slips_or_waves`.
    """
    wave_periods: float = 3.0
    """Periods in a trial of the slowest wave.

    Why: a slower one is drift. Test: `test_decisions.py::test_a_slow_wave_is_drift`.
    """
    same_level: float = 0.05
    """Relative difference of loads of one level.

    The loads are the largest of two trials.

    Why: what a hand-set load varies by.
    Test: `test_decisions.py::test_loads_that_differ_little_are_of_one_level`.
    """
    ci_probs: tuple[float, ...] = (0.5, 0.9)
    """Probability of the central bands whose coverage is shown.

    Why: the middle and the ends.
    Test: `test_decisions.py::test_bands_are_of_a_half_and_of_nine_tenths`.
    """


DECISIONS = DiagnosisDecisions()
