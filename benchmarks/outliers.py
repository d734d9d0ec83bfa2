"""What is answered for clean campaigns with gross errors.

They are 1 to 2 % of the frames. The proof's generator draws them, under three protocols and every
kind of noise.
"""

from __future__ import annotations

import itertools
import tempfile
from collections import Counter
from pathlib import Path

from softfinger.concealed.blind import diagnose_blind
from softfinger.concealed.generate import generate_campaign
from softfinger.concealed.noise import NOISE_KINDS
from softfinger.concealed.suite import CaseSpec

PROTOCOLS = ("single_step", "levels", "triangle")
EACH = 8
PATIENCE_S = 1800.0


def measure_long() -> dict[str, float]:
    """Share of clean campaigns with gross errors that are `adequate`."""
    said = Counter(diagnose_one(spec) for spec in draw_specs(seed=2701))
    print(f"  {dict(said)}", flush=True)
    return {"clean_with_outliers_adequate_share": said["adequate"] / said.total()}


def draw_specs(seed: int) -> list[CaseSpec]:
    """Campaigns to draw: protocols in turn, kinds of noise in turn."""
    noises = itertools.cycle(NOISE_KINDS)
    return [
        CaseSpec(
            seed=seed * 1000 + number,
            effects=(),
            joints=(),
            quantiles=(),
            protocol=protocol,
            trials=(10, 20)[number % 2],
            noise=next(noises),
            nuisances=("outliers",),
        )
        for number, (_, protocol) in enumerate(itertools.product(range(EACH), PROTOCOLS))
    ]


def diagnose_one(spec: CaseSpec) -> str:
    """Draw a campaign and diagnose it; the decision."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        generate_campaign(spec, folder / "campaign", folder / "truth.json")
        found = diagnose_blind(folder / "campaign", folder / "diagnosis", PATIENCE_S)
    answer = found["verdict"]["decision"]
    print(f"  {spec.protocol}, {spec.trials} trials, {spec.noise} noise: {answer}", flush=True)
    return answer
