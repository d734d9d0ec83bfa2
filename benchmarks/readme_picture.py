"""The README's picture, from what ``softfinger demo`` leaves.

``softfinger demo --out results/demo``, then ``python -m benchmarks.readme_picture``.
"""

from pathlib import Path

from softfinger.stages.figure import figure

PROJECT = Path(__file__).resolve().parents[1]
PICTURE = PROJECT / "docs/figures/demo.svg"


def draw_picture(demo: Path, picture: Path) -> None:
    """Draw the bands of the demo's finger beside its recordings."""
    names = ("angles", "bands", "checks", "least_squares", "posterior", "summary")
    paths = {name: demo / f"{name}.nc" for name in names}
    figure(name="bands", figures=[picture], markers=[], **paths)


if __name__ == "__main__":
    draw_picture(PROJECT / "results/demo", PICTURE)
    print(f"written: {PICTURE.relative_to(PROJECT)}")
