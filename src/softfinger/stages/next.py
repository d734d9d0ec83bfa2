"""`softfinger next`: plan the recordings that answer what is open."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from ruamel.yaml import YAML

from softfinger.artifacts import open_artifact, write_atomically
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.verdict import read_verdict
from softfinger.faults import Fault
from softfinger.figures.next_experiment import draw_next_experiment
from softfinger.figures.style import render_figure
from softfinger.gate import read_document
from softfinger.inference.disturbed import admit_known
from softfinger.inference.problem import Candidate, Problem, pose_problem
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mismatch.experiment.account import describe_plan, tabulate_plan
from softfinger.mismatch.experiment.limits import RigLimits
from softfinger.mismatch.experiment.plan import NextExperiment, plan_next
from softfinger.mismatch.experiment.proposal import (
    choose_column,
    pose_open_question,
    recall_limits,
)
from softfinger.mismatch.experiment.purposes import Question, ask_how_much
from softfinger.mismatch.experiment.survivors import (
    OpenModels,
    read_survivors,
    refit_survivors,
)
from softfinger.provenance import derive_seed, hash_files
from softfinger.rig.plan import Plan, read_plan
from softfinger.rig.planned import build_plan, list_paths, list_repeats
from softfinger.rig.profiles import Profile
from softfinger.stages.linear_algebra import on_one_thread
from softfinger.stages.modelled import mend_as_filed
from softfinger.stages.rig_plan import write_proposal

SURVIVORS = "survivors.yaml"


class Asked(NamedTuple):
    """What a user allows, in the units of load log and motion.

    None: what was recorded.
    """

    trials: int
    max_load: float | None = None
    max_angle: float | None = None
    max_rate: float | None = None
    minutes: float | None = None
    rest_s: float | None = None
    fps: float | None = None
    narrow: tuple[str, ...] = ()


@on_one_thread
def next_experiment(
    *, results: Path, plan: Path, asked: Asked, rig: Path | None, campaign: Path | None, seed: int
) -> dict[str, Any]:
    """Write a plan of the next recordings.

    Parameters
    ----------
    results
        Folder of a diagnosis: verdict.json, survivors.yaml, angles.nc.
    plan
        The YAML file that is written; beside it are load logs (CSV), a figure and a JSON document.
    rig, campaign
        A rig's plan, or a campaign folder, that describe finger, camera and recorder.

    Raises
    ------
    Fault
        The folder has no such diagnosis, the limits allow nothing, or the rig cannot run it.
    """
    angles, content = open_diagnosis(Path(results))
    described = None if rig is None else read_plan(rig)
    recorded = open_artifact(angles, angles_spec.SPEC)
    column, scale = choose_column(recorded)
    if described is not None:
        asked = _hold_rig(asked, described, rig, column)
    recorded, problem, base = pose_measured(recorded, content, angles.with_name(SURVIVORS))
    question = pose_question(problem, base, content, asked.narrow)
    limits = read_limits(asked, recorded, problem, scale)
    rng = np.random.default_rng(derive_seed(seed, "next"))
    found = plan_next(problem, question, limits, rng)
    said = describe_plan(found, column, scale)
    with write_atomically(plan.with_suffix(".json")) as temporary:
        text = json.dumps(said, indent=2, ensure_ascii=False) + "\n"
        temporary.write_text(text, encoding="utf-8")
    files = _write_loads(said, plan)
    _write_figure(problem, found, recorded, said, plan.with_suffix(".png"))
    runs = _write_plan(said, limits, plan, rig, campaign)
    return said | {"plan": str(plan), "load_files": files, "runs_on_rig": runs}


def open_diagnosis(results: Path) -> tuple[Path, OpenModels]:
    """Angles and open models of a folder of results.

    Raises
    ------
    Fault
        A file is missing, or the verdict is of another campaign than the angles.
    """
    files = {name: results / name for name in ("verdict.json", SURVIVORS, "angles.nc")}
    for name, file in files.items():
        if not file.is_file():
            raise Fault(
                f"{results}: it has no {name}; give a campaign folder, or the --out of "
                "`softfinger diagnose`"
            )
    verdict = read_verdict(files["verdict.json"])
    campaign = str(open_artifact(files["angles.nc"], angles_spec.SPEC).attrs["campaign"])
    if verdict.campaign != campaign:
        raise Fault(
            f"{files['verdict.json']}: it is of campaign '{verdict.campaign}', and angles.nc of "
            f"'{campaign}'; diagnose the campaign again"
        )
    content = read_survivors(files[SURVIVORS], hash_files(files["angles.nc"]))
    return files["angles.nc"], content


def pose_measured(
    recorded: xr.Dataset, content: OpenModels, survivors: Path
) -> tuple[xr.Dataset, Problem, Candidate]:
    """Pose recordings as they were diagnosed.

    Parameters
    ----------
    recorded
        The `angles` artifact.
    content, survivors
        The open models, and the file that has them.

    Returns
    -------
    recorded, problem, base
        The `angles` artifact set right, and the base model, with the measurement that was found.
    """
    known = MeasurementEntry() if content.measurement is None else content.measurement
    recorded = mend_as_filed(recorded, known, survivors)
    problem, fit = admit_known(*pose_problem(recorded), known.disturbances)
    return recorded, problem, Candidate(problem.base, fit, fit.log_evidence)


def pose_question(
    problem: Problem, base: Candidate, content: OpenModels, narrow: tuple[str, ...]
) -> Question:
    """What the next recordings have to answer."""
    survivors = refit_survivors(problem, base, content)
    if narrow:
        return ask_how_much(problem, survivors[0], narrow)
    open_question = pose_open_question(problem, survivors, content.decision, content.hidden)
    if open_question is not None:
        return open_question
    entries = survivors[0].candidate.model.entries
    amplitudes = [entry.name for entry in entries if entry.parameter.amplitude]
    return ask_how_much(problem, survivors[0], amplitudes or ["k_v", "c_v", "c_p"])


def read_limits(asked: Asked, recorded: xr.Dataset, problem: Problem, scale: float) -> RigLimits:
    """Limits in N m, rad and s.

    What is not asked is as recorded.
    """
    size = float(recorded.attrs.get("motion_per_rad", 1.0))
    usual = recall_limits(problem, recorded, asked.trials)
    rest = usual.rest if asked.rest_s is None else asked.rest_s
    length = problem.setting.duration + rest
    minutes = asked.trials * length / 60.0 if asked.minutes is None else asked.minutes
    return usual._replace(
        load=usual.load if asked.max_load is None else asked.max_load / scale,
        angle=usual.angle if asked.max_angle is None else asked.max_angle / size,
        recalled=asked.max_angle is None,
        rate=np.inf if asked.max_rate is None else asked.max_rate / scale,
        minutes=minutes,
        rest=rest,
        interval=usual.interval if asked.fps is None else 1.0 / asked.fps,
    )


def _hold_rig(asked: Asked, described: Plan, rig: Path, column: str) -> Asked:
    """Take what the rig's plan limits; refuse what it cannot run."""
    if column != "tension_n":
        raise Fault(
            f"{rig}: the rig pulls a wire [N], and this campaign's load is '{column}'; leave "
            "--rig out and run the load files on your own rig"
        )
    limit = described.safety.tension_limit_n
    if asked.max_load is not None and asked.max_load > limit:
        raise Fault(
            f"--max-load {asked.max_load:g}: safety.tension_limit_n of {rig} is {limit:g} N; ask "
            "for less, or raise the limit if the finger allows it"
        )
    if asked.fps is not None and asked.fps > described.fps:
        raise Fault(
            f"--fps {asked.fps:g}: the camera of {rig} takes {described.fps:g} pictures per "
            "second; ask for no more"
        )
    rest = described.recording.rest_s if asked.rest_s is None else asked.rest_s
    return asked._replace(
        rest_s=rest + described.recording.lead_in_s,
        fps=described.fps if asked.fps is None else asked.fps,
    )


def _write_loads(said: Mapping[str, Any], plan: Path) -> list[str]:
    files = []
    for number, load in enumerate(said["loads"], start=1):
        file = plan.with_name(f"{plan.stem}_load_{number}.csv")
        pairs = zip(load["time_s"], load["load"], strict=True)
        rows = [f"{time:.6g},{value:.6g}" for time, value in pairs]
        with write_atomically(file) as temporary:
            head = f"time_s,{said['load_column']}"
            temporary.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
        files.append(str(file))
    return files


def _write_figure(
    problem: Problem, found: NextExperiment, recorded: xr.Dataset, said: Mapping, file: Path
) -> None:
    table = tabulate_plan(problem, found, str(recorded.attrs["source"]))
    _, scale = choose_column(recorded)
    unit = {"tension_n": "N", "torque_nm": "N m"}.get(said["load_column"])
    label = "load" if unit is None else f"load [{unit}]"
    motion, shown = _label_motion(table, recorded)
    table = table.assign(load=scale * table["load_torque"], shown=shown)
    table = table.assign_attrs(load_label=label, motion_label=motion)
    with write_atomically(file) as temporary:
        temporary.write_bytes(render_figure(draw_next_experiment(table), "png"))


def _label_motion(table: xr.Dataset, recorded: xr.Dataset) -> tuple[str, xr.DataArray]:
    """What is on the axis: degrees, or a specimen's own unit."""
    attrs = recorded.attrs
    if "motion_unit" not in attrs:
        return f"joint {table.attrs['joint']} [deg]", table["angle"] * (180.0 / np.pi)
    shown = table["angle"] * attrs["motion_per_rad"] + attrs["motion_zero"]
    return f"{attrs['motion_quantity']} [{attrs['motion_unit']}]", shown


def _write_plan(
    said: Mapping[str, Any], limits: RigLimits, plan: Path, rig: Path | None, campaign: Path | None
) -> bool:
    """Write the plan; whether a rig recorder runs it."""
    if said["load_column"] != "tension_n":
        _write_yaml({key: said[key] for key in ("n_trials", "load_column", "loads")}, plan)
        return False
    profiles = list_paths(said["loads"], limits.trials)
    if rig is not None:
        write_proposal(rig, [profile.model_dump(mode="json") for profile in profiles], plan)
        _set_recording(plan, limits, profiles)
        read_plan(plan)
        return True
    described = {} if campaign is None else read_document(campaign / "campaign.yaml").content
    peak = max(max(load["load"]) for load in said["loads"])
    if {"finger", "camera"} <= set(described) and described["camera"]:
        content = build_plan(described, profiles, limits.trials, limits.rest, peak)
        content["campaign"]["camera"]["fps"] = round(1.0 / limits.interval, 3)
        _write_yaml(content, plan)
        return True
    dumped = [profile.model_dump(mode="json") for profile in profiles]
    _write_yaml({"version": 1, "profiles": dumped}, plan)
    return False


def _set_recording(plan: Path, limits: RigLimits, profiles: list[Profile]) -> None:
    yaml = YAML(typ="rt")
    content = yaml.load(plan.read_text(encoding="utf-8"))
    content["recording"]["repeats"] = list_repeats(profiles, limits.trials)
    content["recording"]["rest_s"] = round(limits.rest - content["recording"]["lead_in_s"], 3)
    content["campaign"]["camera"]["fps"] = round(1.0 / limits.interval, 3)
    with write_atomically(plan) as temporary, temporary.open("w", encoding="utf-8") as stream:
        yaml.dump(content, stream)


def _write_yaml(content: Mapping[str, Any], file: Path) -> None:
    yaml = YAML()
    yaml.width = 200
    with write_atomically(file) as temporary, temporary.open("w", encoding="utf-8") as stream:
        yaml.dump(dict(content), stream)
