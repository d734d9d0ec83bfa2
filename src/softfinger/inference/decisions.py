"""Numbers that decide what an inference trusts."""

from dataclasses import dataclass


@dataclass(frozen=True)
class InferenceDecisions:
    """What is trusted, and what counts as there."""

    largest_k: float = 0.7
    """Largest Pareto k of importance weights in use.

    Why: Vehtari et al. (2024); their error then falls too slowly.
    Test: `test_correction.py::test_a_hopeless_expansion_is_told`.
    """
    least_weighed: int = 25
    """Draws from which weights are smoothed.

    Why: ArviZ smooths a tail of five or more, a fifth of the draws.
    Test: `test_correction.py::test_few_draws_are_not_weighed`.
    """
    least_kept: int = 1000
    """Draws that weighing may leave.

    Why: quantiles of 5 % to a tenth of an sd.
    Test: `test_correction.py::test_draws_of_many_trials_are_kept_as_they_are`.
    """
    load_rows: int = 64
    """Rows of a load log that err alone.

    Of a longer one, neighbours err together.

    Why: rows that err together for longer than a joint's retardation time make a noisy log look
    like friction.
    Test: `test_disturbances.py::test_rows_of_a_log_err_alone_unless_there_are_very_many`.
    """
    few_trials: int = 5
    """Trials below which the report warns.

    The spread is then mostly its prior.

    Why: with as many, the data know a sd to a third.
    Test: `test_inference_decisions.py::test_few_trials_are_warned_of`.
    """
    fallen: float = 0.05
    """Fall of the load that makes a reversal.

    As a share of the largest load.

    Why: as the change of load in `measurement.decisions`.
    Test: `test_inference_decisions.py::test_a_fall_of_the_load_is_a_reversal_or_a_rest`.
    """
    resting: float = 0.1
    """Share of the largest load of a resting finger.

    Why: a slack wire still weighs something.
    Test: `test_inference_decisions.py::test_a_fall_of_the_load_is_a_reversal_or_a_rest`.
    """
    pit_shares: tuple[float, ...] = (1 / 300, 1 / 30, 1 / 3, 1.0)
    """Places in a trial where predictions are checked.

    As shares of its duration.

    Why: 0.1, 1, 10 and 30 s of the paper's.
    Test: `test_inference_decisions.py::test_predictions_are_checked_early_and_late`.
    """


DECISIONS = InferenceDecisions()
