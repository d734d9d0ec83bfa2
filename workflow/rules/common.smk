# Shared by all rules: where things are, and which trials are made together.
from pathlib import Path

from snakemake.exceptions import WorkflowError

from softfinger.campaign import list_tables, read_campaign
from softfinger.campaign.join import list_joined
from softfinger.faults import Fault
from softfinger.provenance import code_hash, environment_hash
from softfinger.stages.keys import choose_settings

OUT = Path(config["out"])
ENVIRONMENT = environment_hash()  # of the libraries; no rule's numbers are without them
SIMULATED = config["campaign"] is None
MODEL = {} if config["model"] is None else {"model": config["model"]}
SEVERAL = config["campaign"] if isinstance(config["campaign"], list) else []
CAMPAIGN = OUT / "campaign" if SIMULATED or SEVERAL else Path(config["campaign"])


def read_joined():
    """Campaigns that are joined; none where the configuration has one, or none."""
    try:
        return [read_campaign(Path(folder)) for folder in SEVERAL]
    except Fault as fault:
        raise WorkflowError(str(fault))


JOINED = read_joined()


def list_recordings():
    """Videos by trial, and every table of the campaign; only files that are there."""
    if SIMULATED:
        names = [f"trial_{k + 1:03d}" for k in range(config["virtual_rig"]["n_trials"])]
        videos = {name: CAMPAIGN / "video" / f"{name}.avi" for name in names}
        logs = [CAMPAIGN / "load" / f"{name}.csv" for name in names]
        return videos, [CAMPAIGN / "campaign.yaml", CAMPAIGN / "trials.csv", *logs]
    if JOINED:
        return {}, list_joined(JOINED, CAMPAIGN)
    try:
        campaign = read_campaign(CAMPAIGN)
    except Fault as fault:
        raise WorkflowError(str(fault))
    videos = {t.name: t.recording for t in campaign.trials if t.level == "video"}
    return videos, list_tables(campaign)


VIDEOS, TABLES = list_recordings()
# Short jobs cost more in starting than in working, so trials go through in batches.
BATCHES = {
    f"{k:04d}": list(VIDEOS)[first : first + config["trials_per_job"]]
    for k, first in enumerate(range(0, len(VIDEOS), config["trials_per_job"]))
}


def batch_videos(wildcards):
    return [VIDEOS[name] for name in BATCHES[wildcards.batch]]


def batch_trials(wildcards):
    return BATCHES[wildcards.batch]


def find_batch(trial):
    return next(batch for batch, names in BATCHES.items() if trial in names)


wildcard_constraints:
    batch=r"\d{4}",
