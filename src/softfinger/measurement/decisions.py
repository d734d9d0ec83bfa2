"""Numbers that decide which frames inform.

They also decide what recordings suffer from.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class MeasurementDecisions:
    """What cleaning and noise are decided by."""

    present_nats: float = 6.0
    """Evidence [nats] from which a noise component is present.

    Why: odds of 400, as there are a dozen components and none is to be found by chance.
    Test: `test_measure.py::test_clean_recordings_suffer_from_nothing`,
    `test_measure.py::test_noise_of_another_size_in_every_trial`.
    """
    reading_nats: float = 1.0
    """Evidence [nats] for the other of two readings of a log, both as likely.

    Why: less is no difference. Test: `test_posed.py::test_a_log_is_read_otherwise_from_a_nat_on`.
    """
    least_share_seen: float = 0.5
    """Share of frames that makes a joint present.

    The frames are those of a trial in which the joint is seen.

    Why: a joint that is seen less costs the others more frames than it has.
    Test: `test_frames.py::test_a_joint_that_was_hardly_seen_does_not_cost_the_others_their_frames`.
    """
    least_frames: int = 8
    """Used frames from which a trial is used.

    Why: a joint has four parameters, and its noise two.
    Test: `test_frames.py::test_a_trial_of_few_frames_is_not_used`.
    """
    gross_sd: float = 6.0
    """Noise sds beyond which a value is a slip.

    It then shows nothing of the noise's tails.

    Why: a normal value lies so far out once in 500 million.
    Test: `test_measurement_decisions.py::test_a_slip_is_no_tail`.
    """
    usual_loss: float = 1e-3
    """Share of frames a sound recording loses or repeats.

    Why: a camera that drops one frame in a thousand is sound.
    Test: `test_measurement_decisions.py::test_few_lost_frames_are_usual`.
    """
    own_rho: float = 9.0
    """Gain from which joints have an autocorrelation each.

    In −2 log L, for each joint.

    Why: three sds of one number.
    Test: `test_noise.py::test_joints_share_one_autocorrelation_unless_it_plainly_differs`.
    """
    good_lost: float = 1e-6
    """Chance that a good frame is an outlier.

    Why: a campaign of 100 000 frames loses none.
    Test: `test_measure.py::test_gross_errors_are_left_out_and_hardly_anything_else`.
    """
    most_outliers: float = 0.2
    """Largest share of outliers in a trial.

    Beyond it none is an outlier.

    Why: outliers are rare; what is not is motion.
    Test: `test_measurement_decisions.py::test_a_trial_of_many_outliers_keeps_all`.
    """
    least_alike: int = 2
    """Least number of other frames to judge one by.

    They are as long after a change of load, or else as many sooner and as many later.

    Why: if one of two is an outlier as well, their median is too large to find any.
    Test: `test_alike.py::test_where_few_frames_compare_none_is_an_outlier`.
    """
    on_the_way: float = 0.1
    """Share of a plateau's rows that may be on the way to it.

    Why: a ramp's last rows hardly differ from the plateau; with more, the load drifts.
    Test: `test_steady.py::test_a_ramp_ends_in_a_plateau_that_is_steadied`.
    """
    plateau_rows: int = 12
    """Rows that a level has at least, where a run has several; either side of a split has half.

    Why: von Neumann's ratio of a crest of n rows is 60 / n^2, 0.42, and of a ramp 12 / n^2.
    Test: `test_steady.py::test_a_curve_is_followed`.
    """
    ramp_rows: int = 20
    """Rows that a straight ramp has at least.

    Why: von Neumann's ratio of what a line leaves of a cubic of n rows is 168 / n^2: 0.42.
    Test: `test_steady.py::test_a_curve_is_followed`.
    """
    scatter_ratio: float = 1.0
    """Von Neumann's ratio above which readings scatter about a level or a line.

    Why: it is 2 for white ones, 1 at an autocorrelation of 0.5, and near 0 for a curve.
    Test: `test_steady.py::test_a_ramp_is_straight_and_no_stair`.
    """
    level_sds: float = 4.0
    """Sds from a level beyond which half a dozen rows at its ends, on average, lead to it.

    Why: one level in sixteen thousand loses half a dozen rows.
    Test: `test_steady.py::test_a_small_ramp_between_levels_is_straight`.
    """
    step_window: int = 40
    """Rows on either side by which a step within a run is judged.

    Why: a ramp takes a few rows of a log, and a drift many.
    Test: `test_steady.py::test_small_steps_are_kept_and_a_drift_is_not`.
    """
    step_nats: float = 10.0
    """Evidence [nats] of two levels over a line from which a run steps.

    Why: forty rows on either side that scatter by half a step reach it, and a drift does not.
    Test: `test_steady.py::test_small_steps_are_kept_and_a_drift_is_not`.
    """
    step_rows: float = 1.5
    """Frame intervals within which two rows of a log state a step.

    Why: the campaign's reader takes them for one.
    Test: `test_step_time.py::test_the_gaps_are_those_in_which_the_reader_sees_steps`.
    """
    same_pace: float = 1.5
    """Ratio of two gaps between rows up to which a log reads at one pace.

    Why: a lost row doubles a gap, and the log then still states what it read before and after.
    Test: `test_open_gaps.py::test_one_lost_row_is_another_pace`.
    """
    pace_rows: int = 12
    """Rows at rest, as far apart as two others, from which a log reads seldom.

    Why: by hand, levels and ramps are stated by a few rows.
    Test: `test_open_gaps.py::test_rows_that_state_a_ramp_or_a_jump_leave_no_gap_open`.
    """
    alike_per_decade: int = 8
    """Groups of such frames in a decade of time.

    The time is that since the change.

    Why: a misfit decays by a third from one to the next.
    Test: `test_measure.py::test_what_every_trial_does_after_a_change_of_load_is_no_outlier`.
    """
    median_frames: int = 15
    """Frames of the running median for outliers.

    Why: bursts of up to seven frames are outliers, longer ones are motion.
    Test: `test_measurement_decisions.py::test_a_short_burst_stands_out_and_a_long_one_does_not`.
    """
    unsettled: float = 0.2
    """Share of the time after a change that is not quiet.

    The time is that between two changes of load.

    Why: by then a quartic follows what moves.
    Test: `test_noise.py::test_before_the_first_load_all_is_quiet`.
    """
    denser: float = 2.0
    """Times that earlier frames are denser than those at rest, to show noise as well.

    Why: what noise does between frames at rest they cannot show.
    Test: `test_noise.py::test_where_frames_thin_out_the_dense_ones_show_the_memory`.
    """
    remembers: float = 0.5
    """Correlation of neighbouring frames at rest from which they show how long noise lasts.

    Why: a memory of less than a frame and a half looks white beside a little white noise.
    Test: `test_noise.py::test_frames_at_rest_that_remember_each_other_are_enough`.
    """
    load_change: float = 0.05
    """Least jump or turn that is a change.

    As a share of the load's range.

    Why: a load cell's noise is less, and a step of a protocol is more.
    Test: `test_noise.py::test_a_dense_log_of_a_steady_load_has_one_change`.
    """
    straight: float = 0.001
    """Distance from a line within which rows of a log are straight.

    As a share of the load's range.

    Why: a smooth wave, cut into such pieces, turns by eight times as much, far less than a change;
    and the corner of a ramp is seen within a thousandth of its length.
    Test: `test_corners.py::test_a_dense_triangle_changes_where_it_turns`.
    """
    lively: float = 3.0
    """Variance beyond which a window is not calm.

    In units of the windows' median.

    Why: χ² of 25 frames reaches that once in a million; a slip does.
    Test: `test_noise.py::test_a_window_that_jumps_is_left_out`.
    """
    window_frames: int = 200
    """Frames of a quiet window, at most.

    Why: a quartic follows a settled finger over a few seconds of a usual camera.
    Test: `test_measurement_decisions.py::test_windows_are_neither_long_nor_short`.
    """
    least_window_frames: int = 25
    """Frames of a quiet window, at least.

    Why: a quartic takes five of them.
    Test: `test_noise.py::test_too_short_recordings_give_no_noise`.
    """
    least_held: float = 0.9
    """Probability from which a frame that equals the one before was held.

    Why: a coarse reader repeats itself without holding.
    Test: `test_measure.py::test_rounded_angles_err_by_their_rounding`,
    `test_measure.py::test_numbers_of_few_digits_repeat_themselves_without_holding`.
    """
    least_distinct: int = 4
    """Distinct values from which a block shows a step.

    Why: three even gaps in a row are no accident.
    Test: `test_measurement_decisions.py::test_what_is_held_shows_no_step`.
    """
    least_values: int = 20
    """Values from which a rounding step is sought.

    Why: few random values lie on some grid by chance.
    Test: `test_measurement_decisions.py::test_few_values_show_no_step`.
    """
    least_saturated: int = 8
    """Equal extremes from which they are a limit.

    Why: noise gives the same extreme hardly twice.
    Test: `test_saturation.py::test_few_equal_extremes_are_no_limit`.
    """
    saturated_frames: int = 5
    """Neighbours of which half at a limit count as one.

    Why: noise lets those below the limit through, and they alone would pull the mean down.
    Test: `test_saturation.py::test_what_is_let_through_beside_the_limit_counts_as_at_it`.
    """


DECISIONS = MeasurementDecisions()
