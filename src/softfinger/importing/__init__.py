"""Recordings of others, read into a campaign folder."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from softfinger.importing.build import ImportedTrial, build_trial
from softfinger.importing.description import FILE_NAME, ImportDescription, read_import_description
from softfinger.importing.faults import ImportFault, ImportFaults
from softfinger.importing.guess import complete
from softfinger.importing.preview import format_preview
from softfinger.importing.sense import find_sign
from softfinger.importing.sources import read_tables
from softfinger.importing.write import refuse_existing, write_campaign

__all__ = [
    "FILE_NAME",
    "Found",
    "ImportFault",
    "ImportFaults",
    "ImportedTrial",
    "format_preview",
    "read_import_description",
    "read_recordings",
    "refuse_existing",
    "write_campaign",
]


class Found(NamedTuple):
    """Trials, how they were read, guesses and losses."""

    description: ImportDescription
    trials: list[ImportedTrial]
    guessed: list[str]
    dropped: list[str]


def read_recordings(source: Path, declared: ImportDescription) -> Found:
    """Read the recordings of a source as trials.

    Parameters
    ----------
    declared : Description
        What is declared; the rest is guessed.

    Raises
    ------
    ImportFault, ImportFaults
        Something cannot be read as asked, or cannot be guessed.
    """
    tables, dropped = read_tables(source, declared.tables)
    files = {table.file for table in tables}
    name = files.pop().stem if len(files) == 1 else source.resolve().stem
    described, runs, guessed, more = complete(tables, declared, name)
    trials, faults = [], []
    for run in runs:
        try:
            trials.append(build_trial(run, described))
        except ImportFault as fault:
            faults.append(str(fault))
    if faults:
        raise ImportFaults(str(source), list(dict.fromkeys(faults)))
    if described.motion.sign is None:
        sign = find_sign(trials)
        motion = described.motion.model_copy(update={"sign": sign})
        described = described.model_copy(update={"motion": motion})
        why = "it moves with the load" if sign == 1 else "as recorded it moves against the load"
        guessed.append(f"motion.sign: {sign} ({why})")
        if sign == -1:
            trials = [build_trial(run, described) for run in runs]
    return Found(described, trials, guessed, [*dropped, *more, *_list_notes(trials)])


def _list_notes(trials: Sequence[ImportedTrial]) -> list[str]:
    return [f"trial {trial.name}: {note}" for trial in trials for note in trial.notes]
