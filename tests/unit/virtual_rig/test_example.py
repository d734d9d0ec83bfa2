from pathlib import Path

from softfinger.campaign import check_campaign, read_campaign
from softfinger.virtual_rig.example import write_example_campaign

COMMITTED = Path(__file__).parents[3] / "data" / "example"


def read_files(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_the_committed_example_is_what_the_rig_makes(tmp_path):
    write_example_campaign(tmp_path)
    assert read_files(tmp_path) == read_files(COMMITTED)


def test_the_example_is_small_and_sound():
    assert sum(len(content) for content in read_files(COMMITTED).values()) < 150_000
    assert check_campaign(COMMITTED) == {}
    campaign = read_campaign(COMMITTED)
    assert len(campaign.trials) == 4
    assert campaign.finger.joints == 3
