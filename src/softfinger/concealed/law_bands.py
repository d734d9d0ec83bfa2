"""Whether a law's curve lies in its band."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from softfinger.concealed.registry import EFFECTS


def measure_coverage(curves: xr.Dataset, truth: Mapping) -> list[float]:
    """Share of each true curve within its band.

    The band is the 90 % band; the share is taken over the recorded range.

    Parameters
    ----------
    curves
        The artifact ``laws.nc``: `value`, `low`, `high` and `argument` (law, place) with `effect`,
        `argument_name`, `kind` and `joint` (law,).
    truth
        What was concealed. Only laws that are a factor of the same argument on every trial alike
        take part; where the argument is zero both are one by definition, and it is left out.
    """
    told = {effect["id"]: effect for effect in truth["effects"] if _is_curve(effect)}
    shares = []
    for k in range(curves.sizes["law"]):
        law = curves.isel(law=k)
        effect = told.get(str(law["effect"].item()))
        if effect is None or str(law["argument_name"].item()) != effect["argument"]:
            continue
        if str(law["kind"].item()) == "sum" or not _acts(effect, int(law["joint"])):
            continue
        x = law["argument"].values
        curve = EFFECTS[effect["name"]].curve(x, truth["case"]["trials"])
        value = 1.0 + effect["strength"] * curve
        inside = (law["low"].values <= value) & (value <= law["high"].values)
        shares.append(float(np.mean(inside[x > 0.0])))
    return shares


def _is_curve(effect: Mapping) -> bool:
    return bool(effect.get("argument")) and not effect.get("scatter")


def _acts(effect: Mapping, joint: int) -> bool:
    """Whether an effect acts on a joint (from 1)."""
    return joint == 0 or not effect["joints"] or joint in effect["joints"]


def collect_laws(judged: Sequence[tuple], shares: Sequence[float]) -> dict[str, float]:
    """Keys of ``results/benchmarks.json`` about foreign laws.

    Parameters
    ----------
    judged
        (truth, judgement) of every campaign.
    shares
        From `measure_coverage`, of every law that was named.
    """
    strange = [
        (len(truth["effects"]), case)
        for truth, case in judged
        if case.visible and truth["effects"] and all(e.get("law") for e in truth["effects"])
    ]
    groups = {
        "law_named_share_single": [case.right for n, case in strange if n == 1],
        "law_named_share_pair": [case.right for n, case in strange if n == 2],
        "law_set_contains_truth_share": [case.contains for _, case in strange],
        "law_false_set_share": [not case.right and case.confident for _, case in strange],
        "law_band_coverage_90": list(shares),
    }
    return {key: float(np.mean(values)) for key, values in groups.items() if values}
