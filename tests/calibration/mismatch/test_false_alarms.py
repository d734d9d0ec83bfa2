"""The bootstrap in the reduced space against full fits: what chance gains in clean campaigns."""

from itertools import product

import numpy as np
import pytest
from scipy.stats import binom

from softfinger.campaign import read_campaign
from softfinger.concealed.generate import generate_campaign
from softfinger.concealed.protocols import PROTOCOLS
from softfinger.concealed.suite import CaseSpec
from softfinger.mismatch import diagnose
from softfinger.tracking import assemble_angles

CONFIG = {
    "bootstrap_replicates": 199,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
    "longest_search_s": 600.0,
}
NOISE = ("white", "ar_0.9", "heavy_tailed", "gappy", "uneven", "ar_0.98")


def draw_p_value(seed, protocol, noise, folder):
    """Probability that chance gains as much as the best full fit does in one clean campaign."""
    spec = CaseSpec(seed, (), (), (), protocol, 10, noise)
    generate_campaign(spec, folder / str(seed), folder / f"{seed}.json")
    angles = assemble_angles(read_campaign(folder / str(seed)), [], {})
    found = diagnose(angles, CONFIG, seed, lambda items, _: items)
    return found.false_alarms.p_value(found.search.first_gain), found.verdict.decision


@pytest.mark.slow
def test_full_fits_of_clean_campaigns_gain_no_more_than_the_bootstrap_says(tmp_path):
    cases = list(product(PROTOCOLS, NOISE))
    drawn = [draw_p_value(7000 + k, *case, tmp_path) for k, case in enumerate(cases)]
    p_value = np.array([p for p, _ in drawn])
    print("p-values of the largest gain:", np.sort(p_value).round(3))
    print(
        "alarms:", [(case, d) for case, (_, d) in zip(cases, drawn, strict=True) if d != "adequate"]
    )
    for level in (0.01, 0.1, 0.3):
        assert np.sum(p_value < level) <= binom.ppf(0.995, len(cases), level)
