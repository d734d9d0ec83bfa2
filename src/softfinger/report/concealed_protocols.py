"""The proof's names by effect, alarms by condition."""

from collections.abc import Mapping, Sequence
from typing import Any

from softfinger.report.blocks import Table, text

NO_EFFECT = ("clean", "outside")


def build_protocols(cases: Sequence[Mapping[str, Any]]) -> Table:
    """Table of right names by effect and protocol.

    Only visible effects count.

    Parameters
    ----------
    cases
        Rows of the table of campaigns: `kind`, `protocol`, `visible` and `right` of each.
    """
    protocols = sorted({case["protocol"] for case in cases})
    kinds = sorted({case["kind"] for case in cases} - set(NO_EFFECT))
    rows = []
    for kind in kinds:
        of_kind = [case for case in cases if case["kind"] == kind]
        groups = [[c for c in of_kind if c["protocol"] == protocol] for protocol in protocols]
        rows.append((text(kind), *(text(count_named(group)) for group in (*groups, of_kind))))
    return Table(
        "protocols",
        "Named, by effect and protocol",
        "Campaigns with a right name, of those in which the oracle gains 15 nats or more; in "
        "brackets those in which it does not, of which no name is asked. Rule score.",
        ("concealed", *protocols, "all"),
        tuple(rows),
    )


def count_named(cases: Sequence[Mapping[str, Any]]) -> str:
    """Count right names among visible cases, and the others.

    >>> count_named([{"visible": True, "right": True}, {"visible": False, "right": True}])
    '1 of 1 (+1)'
    """
    seen = [case["right"] for case in cases if case["visible"]]
    hidden = f"(+{len(cases) - len(seen)})" if len(cases) > len(seen) else ""
    return " ".join(filter(None, (f"{sum(seen)} of {len(seen)}" if seen else "", hidden))) or "–"


def build_conditions(cases: Sequence[Mapping[str, Any]]) -> Table:
    """Table of alarms on clean campaigns by disturbance.

    The disturbances are those of the measurement.

    Parameters
    ----------
    cases
        Rows of the table of campaigns: `condition` and `alarm` of each.
    """
    clean = [case for case in cases if case["alarm"] != ""]
    rows = []
    for condition in sorted({case["condition"] for case in clean}):
        alarms = [case["alarm"] for case in clean if case["condition"] == condition]
        rows.append((text(condition.replace("_", " ")), text(f"{sum(alarms)} of {len(alarms)}")))
    return Table(
        "conditions",
        "Alarms on clean campaigns",
        "By the nuisance that acts on the measurement. An ambiguous answer that leaves the base "
        "model possible is none. Rule score.",
        ("nuisance", "alarms"),
        tuple(rows),
    )
