"""Parameters jump where a finger is mounted anew."""

import numpy as np

from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, signed

LEAST_TRIALS = 4
STARTS = 3  # trials at which a jump is tried
TARGETS = {"k_v": "log_k_v", "c_v": "log_c_v", "c_p": "log_c_p", "q_ini": "q_ini"}
MOVED = {
    "stiffness": ("k_v",),
    "viscosities": ("c_v", "c_p"),
    "everything": ("k_v", "c_v", "c_p"),
    "all_and_angle": ("k_v", "c_v", "c_p", "q_ini"),
}


def _build_form(name: str, setting: Setting) -> Form:
    count = setting.trials
    # flat within a quarter of a trial, so that the trial is meant and no place between two
    place = Parameter(
        "at_trial", count / 2 + 1, count / 4, low=1.5, high=count + 0.5, starts=find_jumps(setting)
    )
    sizes = [_build_size(target) for target in MOVED[name]]

    def slots(values: Values) -> dict:
        after = np.arange(1, count + 1) - float(values["at_trial"]) + 1.0
        share = np.clip((after - 0.25) / 0.5, 0.0, 1.0)
        share = (share**2 * (3.0 - 2.0 * share))[:, None]
        return {
            TARGETS[target]: share * values[size.name]
            for target, size in zip(MOVED[name], sizes, strict=True)
        }

    return Form(name, (*sizes, place), slots)


def _build_session_form(name: str, session: np.ndarray) -> Form:
    """Every later session differs from the first in its own way."""
    later = np.unique(session)[1:]
    sizes = {
        (target, number): _build_size(target, f"_session_{number:g}")
        for target in MOVED[name]
        for number in later
    }

    def slots(values: Values) -> dict:
        return {
            TARGETS[target]: sum(
                (session == number)[:, None] * values[sizes[target, number].name]
                for number in later
            )
            for target in MOVED[name]
        }

    return Form(f"{name}_by_session", tuple(sizes.values()), slots)


def _build_size(target: str, suffix: str = "") -> Parameter:
    """How far a parameter jumps, in each joint."""
    if target == "q_ini":
        return signed(f"change_q_ini_rad{suffix}", 0.02, per="joint", floor=1e-4)
    return signed(
        f"log_ratio_{target}{suffix}",
        0.2,
        per="joint",
        floor=2e-4,
        report={f"ratio_{target}{suffix}": lambda x, _: float(np.exp(x))},
    )


def find_jumps(setting: Setting) -> tuple[float, ...]:
    """First trials (STARTS,) after the largest jumps."""
    count = setting.trials
    if setting.drift is None:
        return tuple(np.round(np.linspace(2, count, STARTS + 2)[1:-1]).astype(float))
    values = setting.drift.reshape(count, -1)
    values = (values - values.mean(axis=0)) / np.maximum(values.std(axis=0), 1e-12)
    before = np.arange(1, count)
    total = np.cumsum(values, axis=0)[:-1]
    gain = (total**2).sum(axis=1) * (1.0 / before + 1.0 / (count - before))
    return tuple(float(before[k] + 1) for k in np.argsort(-gain, kind="stable")[:STARTS])


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.trials < LEAST_TRIALS:
        return f"a jump between trials needs at least {LEAST_TRIALS} of them"
    forms = [_build_form(name, setting) for name in MOVED]
    session = setting.covariates.get("session", np.zeros(setting.trials))
    if np.unique(session).size > 1:
        forms += [_build_session_form(name, session) for name in MOVED]
    return forms


EFFECT = Effect("session_jump", "the parameters jump at one trial", "between_trials", _build_forms)
