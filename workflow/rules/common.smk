# What every rule needs: where things are, and which trials are made together.
from pathlib import Path

from snakemake.exceptions import WorkflowError

from softfinger.campaign import read_campaign
from softfinger.faults import Fault
from softfinger.provenance import code_hash

OUT = Path(config["out"])
SIMULATED = config["campaign"] is None
CAMPAIGN = OUT / "campaign" if SIMULATED else Path(config["campaign"])
TABLES = [CAMPAIGN / "campaign.yaml", CAMPAIGN / "trials.csv"]


def list_recordings():
    """Videos by trial, and every table that trials.csv names; only files that are there."""
    if SIMULATED:
        names = [f"trial_{k + 1:03d}" for k in range(config["virtual_rig"]["n_trials"])]
        videos = {name: CAMPAIGN / "video" / f"{name}.avi" for name in names}
        return videos, [CAMPAIGN / "load" / f"{name}.csv" for name in names]
    try:
        trials = read_campaign(CAMPAIGN).trials
    except Fault as fault:
        raise WorkflowError(str(fault))
    videos = {t.name: t.recording for t in trials if t.level == "video"}
    logs = sorted({t.load for t in trials if t.load is not None})
    return videos, [t.recording for t in trials if t.level != "video"] + logs


VIDEOS, RECORDED_TABLES = list_recordings()
# Short jobs cost more in starting than in working, so trials go through in batches.
BATCHES = {
    f"{k:04d}": list(VIDEOS)[first : first + config["trials_per_job"]]
    for k, first in enumerate(range(0, len(VIDEOS), config["trials_per_job"]))
}


def batch_videos(wildcards):
    return [VIDEOS[name] for name in BATCHES[wildcards.batch]]


def batch_trials(wildcards):
    return BATCHES[wildcards.batch]


wildcard_constraints:
    batch=r"\d{4}",
