"""The proof's score, with binomial intervals."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from scipy.stats import beta

from softfinger.concealed.effects import CATALOGUES
from softfinger.concealed.judge import SAME_IN_EVERY_FORM, Judgement, judge
from softfinger.concealed.law_bands import collect_laws, measure_coverage
from softfinger.concealed.limit import compute_limit
from softfinger.concealed.measurement import (
    check_findings,
    collect_measurement,
    list_alarms,
    pair_twins,
)

TRUTHS = ("clean", *CATALOGUES["second"], "two effects", "outside")
ANSWERS = ("adequate", *CATALOGUES["second"], "two effects", "ambiguous", "unlisted", "crashed")
GAIN_EDGES = np.array([-np.inf, 1.0, 3.0, 7.0, 15.0, 30.0, 100.0, 1000.0, np.inf])
PROBABILITY_EDGES = np.array([0.0, 0.05, 0.2, 0.5, 0.8, 0.95, 0.99, 1.0])
SURE = 0.95  # probability from which on the oracle, like a verdict, names
BENCHMARKS = {
    "concealed_named_share": "named",
    "concealed_nameable_share": "nameable",
    "concealed_named_share_of_nameable": "named_nameable",
    "concealed_false_alarm_share": "false_alarm",
    "concealed_unlisted_share": "unlisted",
    "concealed_unlisted_share_of_recognisable": "unlisted_recognisable",
    "concealed_set_contains_truth_share": "set_contains_truth",
    "concealed_interval_coverage_90": "interval_coverage_90",
}


def score(
    verdicts: Sequence[dict],
    truths: Sequence[dict],
    limits: Sequence[dict] | None = None,
    *,
    curves: Sequence[xr.Dataset | None] | None = None,
    seconds: Sequence[float] | None = None,
) -> xr.Dataset:
    """Score verdicts against truths, case by case.

    Parameters
    ----------
    verdicts, truths
        Contents of the ``verdict.json`` and truth files.
    limits : sequence of dict, optional
        From `limit.weigh_stand_ins`; without them the oracle is compared with the base model only.
    curves : sequence of Dataset, optional
        The artifacts ``laws.nc``; None where there is none.
    seconds : sequence of float, optional
        How long each diagnosis took [s].

    Returns
    -------
    Dataset
        confusion (truth, answer): counts. share, share_lower, share_upper, share_count
        (statistic): proportions with 95 % Clopper–Pearson intervals, NaN where nothing counts.
        right_by_gain and its bounds and count (gain_bin), with could_by_gain, the probability that
        the oracle itself gives the truth against the base model and the rest of the catalogue.
        stated_probability, true_share and its bounds, stated_count (probability_bin). Per case:
        gain [nats], right, listed (an effect of the catalogue was concealed), gap_closed, seconds.
        Attributes gap_closed_median; measurement and laws, with the keys of `collect_measurement`
        and of `collect_laws`.
    """
    cases = [judge(v, t) for v, t in zip(verdicts, truths, strict=True)]
    limits = [{}] * len(cases) if limits is None else limits
    could = np.array([compute_limit(t, w) for t, w in zip(truths, limits, strict=True)])
    seconds = np.full(len(cases), np.nan) if seconds is None else np.asarray(seconds, float)
    gap = np.array([np.nan if c.gap_closed is None else c.gap_closed for c in cases])
    scored = xr.Dataset(
        {
            "confusion": (("truth", "answer"), _count_answers(cases)),
            "gain": ("case", [c.gain for c in cases]),
            "right": ("case", [c.right for c in cases]),
            "listed": ("case", [c.truth not in ("clean", "outside") for c in cases]),
            "gap_closed": ("case", gap),
            "seconds": ("case", seconds),
        },
        coords={"truth": list(TRUTHS), "answer": list(ANSWERS), "case": np.arange(len(cases))},
    )
    told = list(zip(verdicts, truths, strict=True))
    scored.attrs["measurement"] = collect_measurement(told)
    scored.attrs["laws"] = collect_laws(
        list(zip(truths, cases, strict=True)), _cover(cases, truths, curves)
    )
    scored.attrs["gap_closed_median"] = (
        float(np.nanmedian(gap)) if np.isfinite(gap).any() else np.nan
    )
    return xr.merge(
        [
            scored,
            _count_shares(cases, told, could),
            _trace_curve(cases, could),
            _check_probabilities(cases),
        ],
        combine_attrs="override",
    )


def compute_share(hits: int, count: int) -> tuple[float, float, float]:
    """Share with its 95 % Clopper–Pearson interval.

    It is NaN where nothing counts.

    Examples
    --------
    >>> [round(x, 3) for x in compute_share(0, 10)]
    [0.0, 0.0, 0.308]
    """
    if count == 0:
        return np.nan, np.nan, np.nan
    lower = beta.ppf(0.025, hits, count - hits + 1) if hits else 0.0
    upper = beta.ppf(0.975, hits + 1, count - hits) if hits < count else 1.0
    return hits / count, float(lower), float(upper)


def collect_benchmarks(scored: xr.Dataset) -> dict[str, float]:
    """Keys of ``results/benchmarks.json``; what was not measured is absent."""
    found = {
        key: float(scored.share.sel(statistic=statistic)) for key, statistic in BENCHMARKS.items()
    }
    found["concealed_gap_closed_median"] = scored.attrs["gap_closed_median"]
    found |= scored.attrs["measurement"] | scored.attrs["laws"]
    return {key: value for key, value in found.items() if np.isfinite(value)}


def shuffle_truths(
    verdicts: Sequence[dict], truths: Sequence[dict], rng: np.random.Generator, repeats: int = 200
) -> float:
    """Share of right names by chance.

    It is the mean over verdicts that are dealt out at random.

    Only visible effects of the catalogue take part, as in the share of right names.
    """
    taking_part = [
        (v, t) for v, t in zip(verdicts, truths, strict=True) if _counts_as_named(judge(v, t))
    ]
    if not taking_part:
        return np.nan
    dealt, kept = zip(*taking_part, strict=True)
    shares = []
    for _ in range(repeats):
        order = rng.permutation(len(kept))
        rights = [judge(dealt[i], t).right for i, t in zip(order, kept, strict=True)]
        shares.append(np.mean(rights))
    return float(np.mean(shares))


def _cover(
    cases: list[Judgement], truths: Sequence[dict], curves: Sequence[xr.Dataset | None] | None
) -> list[float]:
    """Coverage of the laws that were rightly named."""
    known = [None] * len(cases) if curves is None else curves
    return [
        share
        for case, truth, curve in zip(cases, truths, known, strict=True)
        if case.right and curve is not None
        for share in measure_coverage(curve, truth)
    ]


def _counts_as_named(case: Judgement) -> bool:
    return case.visible and case.truth != "outside"


def _count_answers(cases: list[Judgement]) -> np.ndarray:
    counts = np.zeros((len(TRUTHS), len(ANSWERS)), int)
    for case in cases:
        answer = case.answer if case.answer in ANSWERS else "unlisted"  # a user's own effect
        counts[TRUTHS.index(case.truth), ANSWERS.index(answer)] += 1
    return counts


def _count_shares(
    cases: list[Judgement], told: Sequence[tuple[dict, dict]], could: np.ndarray
) -> xr.Dataset:
    clean = [c for c in cases if c.truth == "clean"]
    listed = [c for c in cases if c.truth not in ("clean", "outside")]
    zero = [c for c, (_, t) in zip(cases, told, strict=True) if -1.0 in t["case"]["quantiles"]]
    pairs, (found, false) = pair_twins(told), check_findings(told)
    known = [(c, bool(p >= SURE)) for c, p in zip(cases, could, strict=True) if c.visible]
    sure = [pair for pair in known if _counts_as_named(pair[0])]
    outside = [pair for pair in known if pair[0].truth == "outside"]
    hits = {
        "named": [c.right for c in cases if _counts_as_named(c)],
        "nameable": [nameable for _, nameable in sure],
        "named_nameable": [c.right for c, nameable in sure if nameable],
        "named_single": [c.right for c in listed if c.visible and c.truth != "two effects"],
        "named_two": [c.right for c in listed if c.visible and c.truth == "two effects"],
        "false_alarm": [not c.right for c in clean],
        "clean_alarm": [alarm for _, alarm in list_alarms(told)],
        "strength_zero_adequate": [c.right for c in zero],
        "twin_named_without": [without for without, _ in pairs],
        "twin_named_with": [with_nuisance for _, with_nuisance in pairs],
        "measurement_named": found,
        "measurement_false": false,
        "crashed": [c.answer == "crashed" for c in cases],
        "buried_wrongly_named": [
            c.answer != "adequate" and not c.contains for c in listed if not c.visible
        ],
        "unlisted": [c.right for c, _ in outside],
        "recognisable": [recognisable for _, recognisable in outside],
        "unlisted_recognisable": [c.right for c, recognisable in outside if recognisable],
        "set_contains_truth": [c.contains for c in cases if c.masked],
        "set_contains_truth_visible": [c.contains for c in listed if c.visible],
        **_list_estimates(cases),
    }
    return _tabulate_shares(hits)


def _tabulate_shares(hits: dict[str, list[bool]]) -> xr.Dataset:
    rows = np.array([compute_share(sum(v), len(v)) for v in hits.values()])
    return xr.Dataset(
        {
            "share": ("statistic", rows[:, 0]),
            "share_lower": ("statistic", rows[:, 1]),
            "share_upper": ("statistic", rows[:, 2]),
            "share_count": ("statistic", [len(v) for v in hits.values()]),
        },
        coords={"statistic": list(hits)},
    )


def _list_estimates(cases: list[Judgement]) -> dict[str, list[bool]]:
    covered = [pair for c in cases for pair in c.covered.items()]
    hits = {
        "interval_coverage_90": [hit for key, hit in covered if key in SAME_IN_EVERY_FORM],
        "interval_coverage_90_any_form": [hit for _, hit in covered],
    }
    for part in ("joints", "level", "window", "covariate"):
        hits[f"location_{part}"] = [value for c in cases if (value := getattr(c, part)) is not None]
    return hits


def _trace_curve(cases: list[Judgement], could: np.ndarray) -> xr.Dataset:
    is_listed = np.array([c.truth not in ("clean", "outside") for c in cases], bool)
    listed, could = (
        [c for c, there in zip(cases, is_listed, strict=True) if there],
        could[is_listed],
    )
    gain = np.array([c.gain for c in listed])
    right = np.array([c.right for c in listed], bool)
    at = np.digitize(gain, GAIN_EDGES) - 1
    bins = range(GAIN_EDGES.size - 1)
    rows = np.array([compute_share(int(right[at == b].sum()), int((at == b).sum())) for b in bins])
    return xr.Dataset(
        {
            "right_by_gain": ("gain_bin", rows[:, 0]),
            "right_by_gain_lower": ("gain_bin", rows[:, 1]),
            "right_by_gain_upper": ("gain_bin", rows[:, 2]),
            "count_by_gain": ("gain_bin", [int((at == b).sum()) for b in bins]),
            "could_by_gain": (
                "gain_bin",
                [could[at == b].mean() if (at == b).any() else np.nan for b in bins],
            ),
        },
        coords={"gain_bin": GAIN_EDGES[:-1], "gain_bin_end": ("gain_bin", GAIN_EDGES[1:])},
    )


def _check_probabilities(cases: list[Judgement]) -> xr.Dataset:
    pairs = np.array([pair for c in cases for pair in c.stated], float).reshape(-1, 2)
    at = np.clip(np.digitize(pairs[:, 0], PROBABILITY_EDGES) - 1, 0, PROBABILITY_EDGES.size - 2)
    groups = [pairs[at == b] for b in range(PROBABILITY_EDGES.size - 1)]
    mean = [g.mean(axis=0) if len(g) else np.full(2, np.nan) for g in groups]
    bounds = [compute_share(int(g[:, 1].sum()), len(g)) for g in groups]
    return xr.Dataset(
        {
            "stated_probability": ("probability_bin", [m[0] for m in mean]),
            "true_share": ("probability_bin", [m[1] for m in mean]),
            "true_share_lower": ("probability_bin", [b[1] for b in bounds]),
            "true_share_upper": ("probability_bin", [b[2] for b in bounds]),
            "stated_count": ("probability_bin", [len(g) for g in groups]),
        },
        coords={"probability_bin": PROBABILITY_EDGES[:-1]},
    )
