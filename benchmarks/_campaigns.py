"""The committed set of campaigns on which the diagnosis is timed.

The proof's generator draws them from a committed seed: all protocols, two to four joints, 1 to 100
trials, clean, one effect, two, one from outside the catalogue, with and without nuisances. Beside
them are real recordings, where the variable SOFTFINGER_REALDATA names their folder.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from softfinger.concealed.noise import NoiseKind
from softfinger.concealed.population import Population
from softfinger.concealed.protocols import Protocol
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import Setting, draw_setting, record_cleanly, set_strengths
from softfinger.concealed.spoil import spoil
from softfinger.concealed.suite import CaseSpec
from softfinger.concealed.writer import write_campaign

SEED = 3200
REAL = ("softfinger-a", "polystyrene-190", "spruce-lr", "sma-limb")
Acting = tuple[str, tuple[int, ...]]


@dataclass(frozen=True)
class Drawn:
    """A campaign before anything in it is drawn; an effect's joints count from 0."""

    protocol: Protocol
    trials: int
    joints: int = 3
    effects: tuple[Acting, ...] = ()
    nuisances: tuple[str, ...] = ()
    noise: NoiseKind = "white"


DRAWN: dict[str, Drawn] = {
    "step_1_creep": Drawn("single_step", 1, 3, (("fractional_creep", (0, 1, 2)),)),
    "step_100_temperature": Drawn("single_step", 100, 3, (("temperature", (0, 1, 2)),)),
    "step_10_clean_spoilt": Drawn("single_step", 10, 4, (), ("hum", "outliers")),
    "levels_10_friction": Drawn("levels", 10, 3, (("wire_friction", ()),)),
    "levels_40_clean": Drawn("levels", 40, 4, noise="correlated"),
    "levels_20_pair": Drawn(
        "levels", 20, 3, (("second_retardation", (1,)), ("gravity", ())), ("lost_frames",)
    ),
    "levels_20_spoilt": Drawn(
        "levels", 20, 3, (("strain_stiffening", (0, 1, 2)),), ("clock_rate", "camera_drift")
    ),
    "staircase_10_flow": Drawn("staircase", 10, 2, (("stress_nonlinear_flow", (0, 1)),)),
    "staircase_40_pair": Drawn(
        "staircase", 40, 3, (("yield_threshold", (0, 1, 2)), ("actuator_lag", ()))
    ),
    "staircase_20_outside": Drawn("staircase", 20, 3, (("mullins_softening", (0, 1, 2)),)),
    "triangle_4_clean": Drawn("triangle", 4, 2),
    "triangle_10_arm": Drawn("triangle", 10, 3, (("moment_arm", ()),)),
    "triangle_20_pair": Drawn(
        "triangle", 20, 3, (("wire_friction", ()), ("second_retardation", (0, 1, 2)))
    ),
    "triangle_40_lag": Drawn("triangle", 40, 3, (("actuator_lag", ()),), ("noisy_load",)),
}


def list_campaigns(folder: Path) -> Iterator[tuple[str, Path]]:
    """Names and folders of the set; what is drawn is written at its turn, once."""
    for number, (name, drawn) in enumerate(DRAWN.items()):
        place = folder / name
        if not (place / "trials.csv").is_file():
            write_drawn(drawn, SEED + number, place)
        yield name, place
    if real := os.environ.get("SOFTFINGER_REALDATA"):
        yield from ((name, Path(real) / name) for name in REAL if (Path(real) / name).is_dir())


def write_drawn(drawn: Drawn, seed: int, folder: Path) -> None:
    """Write one campaign; each effect is at least as strong as it typically is."""
    rng = np.random.default_rng([seed, 32])
    names = tuple(name for name, _ in drawn.effects)
    spec = CaseSpec(
        seed=seed,
        effects=names,
        joints=tuple(joints for _, joints in drawn.effects),
        quantiles=(),
        protocol=drawn.protocol,
        trials=drawn.trials,
        noise=drawn.noise,
        nuisances=drawn.nuisances,
    )
    setting = change_joints(draw_setting(spec), drawn.joints)
    kinds = [EFFECTS[name] for name in names]
    strengths = {
        name: float(np.exp(rng.uniform(*np.log([kind.typical, kind.largest]))))
        for name, kind in zip(names, kinds, strict=True)
    }
    doses = set_strengths(setting.doses, strengths)
    clean = record_cleanly(setting, doses, np.arange(drawn.trials))
    sights = spoil(setting, doses, clean, seed)
    recordings, logs = [s.recording for s in sights], [s.rows for s in sights]
    write_campaign(folder, setting, recordings, logs, declares_noise=False)


def change_joints(setting: Setting, joints: int) -> Setting:
    """Leave out joints at the tip, or add joints that are like the first ones."""
    like = np.arange(joints) % setting.rig.joints
    rng = np.random.default_rng(joints)
    population = Population(setting.population.mean[:, like], setting.population.sd[:, like])
    individuals = setting.individuals[..., like]
    added = np.arange(joints) >= setting.rig.joints
    drawn = population.mean + population.sd * rng.normal(size=individuals.shape)
    return replace(
        setting,
        rig=replace(
            setting.rig,
            link_length=setting.rig.link_length[like],
            link_mass=setting.rig.link_mass[like],
        ),
        population=population,
        individuals=np.where(added, drawn, individuals),
    )
