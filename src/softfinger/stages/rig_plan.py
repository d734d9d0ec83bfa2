"""`softfinger rig plan`: choose a protocol for effects."""

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr
from ruamel.yaml import YAML

from softfinger.artifacts import open_artifact, save_artifact, write_atomically
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import visibility as visibility_spec
from softfinger.campaign import read_campaign
from softfinger.faults import Fault
from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.experiment.protocols import (
    PlannedProtocol,
    choose_protocol,
    measure_separation,
    plan_experiment,
)
from softfinger.provenance import describe_run
from softfinger.rig.plan import Plan, read_plan
from softfinger.rig.proposals import (
    describe_profiles,
    measure_reach,
    propose_profiles,
    stack_knots,
)
from softfinger.stages.linear_algebra import on_one_thread
from softfinger.tracking import assemble_angles
from softfinger.virtual_rig.campaign_folder import write_campaign_folder
from softfinger.virtual_rig.config import N_JOINTS
from softfinger.virtual_rig.motion import draw_motion

PRESENT = "as_planned"


@on_one_thread
def rig_plan(
    *,
    plan: Path,
    wanted: Sequence[str],
    angles: Path | None,
    visibility: Path,
    proposal: Path,
    config: Mapping[str, Any],
    seed: int,
) -> tuple[str, xr.Dataset] | None:
    """Write what each protocol would show.

    The plan gets the profiles that show most.

    Parameters
    ----------
    plan
        The rig's plan; its highest tension and longest profile are the limits.
    wanted
        Ids of effects to tell apart; none: every one that any protocol can have.
    angles
        The `angles` artifact of an earlier campaign with the same finger: its population and
        noise; None takes the paper's finger with the plan's geometry.
    visibility, proposal
        The artifact and the plan that are written.
    config
        What the virtual rig reads of the configuration; used where there are no `angles`.

    Returns
    -------
    name of the protocol, visibility
        None where no protocol would show any of the wanted effects; the plan is then not written.
    """
    described = read_plan(plan)
    roles = {"plan": plan} if angles is None else {"plan": plan, "angles": angles}
    knobs = configure_rig(described, config) if angles is None else {}
    provenance = describe_run("rig_plan", roles, {"wanted": list(wanted), **knobs}, seed)
    recorded = (
        simulate_campaign(knobs, seed)
        if angles is None
        else open_artifact(angles, angles_spec.SPEC)
    )
    problem, fit = pose_problem(recorded)
    profiles = {PRESENT: described.profiles, **propose_profiles(*measure_reach(described.profiles))}
    arm = float(recorded["wire_offset"])
    if not arm > 0:
        raise Fault(f"{plan}: the finger's wire_offset_m is not known; declare it to plan tensions")
    protocols = {}
    for name, listed in profiles.items():
        time, tension = stack_knots(listed)
        protocols[name] = PlannedProtocol(time, arm * tension)
    base = Candidate(problem.base, fit, fit.log_evidence)
    tables = plan_experiment(problem, base, protocols)
    known = sorted({str(effect) for table in tables.values() for effect in table["effect"].values})
    unknown = sorted(set(wanted) - set(known))
    if unknown:
        raise Fault(
            f"no protocol can show '{unknown[0]}' on this rig; choose from {', '.join(known)}"
        )
    best = choose_protocol(tables, wanted or known, DECISIONS.shows)
    gathered = gather_tables(tables, wanted or known)
    save_artifact(gathered, visibility_spec.SPEC, visibility, provenance)
    if best is None:
        return None
    write_proposal(plan, describe_profiles(profiles[best[0]]), proposal)
    return best[0], gathered


def configure_rig(plan: Plan, config: Mapping[str, Any]) -> dict[str, Any]:
    """Virtual rig of a plan: twelve single steps."""
    finger = plan.campaign["finger"]
    if finger.get("joints") != N_JOINTS:
        raise Fault(
            f"a plan without data is for the paper's finger of {N_JOINTS} joints, and yours has "
            f"{finger.get('joints')}; record a few trials and name their campaign with --campaign"
        )
    peak, duration = measure_reach(plan.profiles)
    own = {key: finger[key] for key in set(finger) & set(config)}
    return {
        **config,
        **own,
        "level": "angles",
        "n_trials": DECISIONS.design_trials,
        "duration_s": duration,
        "fps": plan.fps,
        "load_time_s": [0.0, duration],
        "load_tension_n": [peak, peak],
    }


def simulate_campaign(knobs: Mapping[str, Any], seed: int) -> xr.Dataset:
    """Record a campaign on the virtual rig."""
    with tempfile.TemporaryDirectory() as folder:
        write_campaign_folder(draw_motion(knobs, seed), knobs, Path(folder), seed)
        return assemble_angles(read_campaign(folder), [])


def gather_tables(tables: Mapping[str, xr.Dataset], wanted: Sequence[str]) -> xr.Dataset:
    """Gather protocols' tables, NaN for impossible effects."""
    protocol = xr.DataArray(list(tables), dims="protocol", name="protocol")
    shown = xr.concat(
        [table[["signal", "share_left", "expected_gain"]] for table in tables.values()],
        dim=protocol,
        join="outer",
    )
    separation = [measure_separation(table, wanted) for table in tables.values()]
    apart = xr.concat(separation, dim=protocol).reindex(effect=shown["effect"])
    return shown.assign(separation=apart).transpose("protocol", "effect")


def write_proposal(plan: Path, profiles: Sequence[Mapping[str, object]], path: Path) -> None:
    """Write a plan with other profiles, remarks kept."""
    yaml = YAML(typ="rt")
    content = yaml.load(plan.read_text(encoding="utf-8"))
    content["profiles"] = list(map(dict, profiles))
    with write_atomically(path) as temporary, temporary.open("w", encoding="utf-8") as stream:
        yaml.dump(content, stream)
