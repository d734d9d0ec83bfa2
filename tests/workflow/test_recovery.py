"""Both ways of fitting against the truth: asked for by name, and no part of the main job."""

import csv


def test_the_table_of_a_simulated_campaign_is_made_on_demand(finished):
    results = finished.root / "results"
    assert not (results / "recovery.nc").exists()
    finished.snakemake("recovery", "--cores", "1")
    rows = list(csv.DictReader((results / "recovery.csv").read_text().splitlines()))
    assert {row["estimate"] for row in rows} == {"two_stage", "posterior"}
