"""Sobol indices of the joint angle over time."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_SERIES = ("joint", "time")
_DESIGN = ("change", "joint", "running_time", "parameter")
# Rounding: an index is a ratio of quadratures.
_SHARE = {"at_least": -1e-9, "at_most": 1.0 + 1e-9}


_DIFFERENCE = {**_SHARE, "at_least": -1.0 - 1e-9}  # negative where two parameters do the same


def _index(dims: tuple[str, ...], long_name: str, within: dict[str, float] = _SHARE) -> Variable:
    return Variable(dims, "1", long_name, compress=True, **within)


SPEC = ArtifactSpec(
    name="sobol",
    title="Sobol indices of the joint angle over time",
    rule="sobol",
    attrs=("definition", "protocol", "protocol_n_trials", "truncation"),
    coords={
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "time": Variable(("time",), "s", "time since the start of the protocol"),
        "estimate": Variable(("estimate",), "1", "two_stage or posterior", "text"),
        "parameter": Variable(("parameter",), "1", "parameter that varies", "text"),
        "pair": Variable(("pair",), "1", "pair of parameters", "text"),
        "quantile": Variable(("quantile",), "1", "quantile over the posterior's draws"),
        "change": Variable(("change",), "1", "what is done to the parameter's spread", "text"),
        "running_time": Variable(("running_time",), "s", "time for which the finger is used"),
    },
    variables={
        "first_order": _index(("estimate", *_SERIES, "parameter"), "first-order index"),
        "total": _index(("estimate", *_SERIES, "parameter"), "total index"),
        "second_order": _index(("estimate", *_SERIES, "pair"), "second-order index", _DIFFERENCE),
        "first_order_quantile": _index((*_SERIES, "parameter", "quantile"), "its quantile"),
        "total_quantile": _index((*_SERIES, "parameter", "quantile"), "its quantile"),
        "second_order_quantile": _index(
            (*_SERIES, "pair", "quantile"), "its quantile", _DIFFERENCE
        ),
        "angle_sd": Variable(
            ("estimate", *_SERIES), "rad", "standard deviation of the angle", at_least=0.0
        ),
        "angle_sd_quantile": Variable((*_SERIES, "quantile"), "rad", "its quantile", at_least=0.0),
        "spread": Variable(
            ("estimate", "joint", "running_time"),
            "rad",
            "spread of the angle within that time",
            at_least=0.0,
        ),
        "spread_shrinkage": Variable(
            ("estimate", *_DESIGN), "1", "share of the spread that the change would remove"
        ),
        "spread_shrinkage_quantile": Variable((*_DESIGN, "quantile"), "1", "its quantile"),
    },
)
