"""Recordings and the model file that they are read with."""

from pathlib import Path
from typing import NamedTuple

import xarray as xr

from softfinger.faults import Fault
from softfinger.measurement.mend import mend_recordings
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.effects.model_file import ModelFile, read_model_file


class Modelled(NamedTuple):
    """Recordings, the model for them, and whether its priors count.

    Where the model was fitted to these very recordings, its priors do not count, and they are set
    right by its `measurement`. Of a model from elsewhere `measurement` is left out.
    """

    angles: xr.Dataset
    content: ModelFile | None
    priors: bool


def read_modelled(recorded: xr.Dataset, sha256: str, model: Path | None) -> Modelled:
    """Read recordings as a model file has them.

    Parameters
    ----------
    recorded, sha256
        The `angles` artifact, and its hash.

    Raises
    ------
    Fault
        The file cannot be used, or its measurement is not of these recordings.
    """
    if model is None:
        return Modelled(recorded, None, priors=True)
    content = read_model_file(model)
    if not content.was_fitted_to(sha256):
        elsewhere = content.model_copy(update={"measurement": None})
        return Modelled(recorded, elsewhere, priors=True)
    if content.measurement is not None:
        recorded = mend_as_filed(recorded, content.measurement, model)
    return Modelled(recorded, content, priors=False)


def mend_as_filed(recorded: xr.Dataset, known: MeasurementEntry, file: Path) -> xr.Dataset:
    """Mend recordings by what a file knows of them.

    Raises
    ------
    Fault
        `known` cannot be of these recordings; it names the file.
    """
    try:
        return mend_recordings(recorded, known)
    except Fault as fault:
        raise Fault(f"{file}: {fault}") from fault
