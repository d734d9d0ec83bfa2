"""What a proof consists of."""

from softfinger.concealed.foreigners import draw_foreign
from softfinger.concealed.suite import (
    TRIALS,
    CaseSpec,
    Catalogue,
    Kind,
    build_paper_case,
    draw_catalogue,
    draw_suite,
)
from softfinger.concealed.unkind import draw_clean, draw_twins


def draw_proof(
    seed: int,
    campaigns: int,
    filmed: int,
    longest: int,
    kind: Kind = "sample",
    *,
    clean: int = 0,
    twins: int = 0,
    foreign: int = 0,
    catalogue: Catalogue = "first",
) -> list[CaseSpec]:
    """Draw what a proof consists of.

    First the suite, then the paper's own case in two protocols, then clean campaigns with
    nuisances, pairs of campaigns with and without them, and foreign laws. What comes later leaves
    what comes before as it is.

    Parameters
    ----------
    seed, campaigns, filmed, longest
        As for `draw_suite`.
    kind
        A balanced `sample` of everything, or the `catalogue`'s effects, plainly visible.
    clean
        How many clean campaigns over all conditions of the measurement.
    twins
        How many pairs that differ by their nuisances alone.
    foreign
        How many campaigns with foreign laws, the `longest` of them too.
    catalogue
        Which ids the catalogue under test has.
    """
    trials = min(max(TRIALS), longest)
    paper = [build_paper_case(protocol, trials, seed) for protocol in ("levels", "single_step")]
    if kind == "catalogue":
        suite = draw_catalogue(seed, campaigns, longest=longest, catalogue=catalogue)
    else:
        suite = draw_suite(seed, campaigns, filmed=filmed, longest=longest, catalogue=catalogue)
    unkind = [*draw_clean(seed, clean), *draw_twins(seed, twins, catalogue)]
    strange = draw_foreign(seed, foreign, longest=longest, catalogue=catalogue)
    return [*suite, *paper, *unkind, *strange]
