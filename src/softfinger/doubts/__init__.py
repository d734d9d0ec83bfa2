"""What looks wrong in a campaign.

Every kind of doubt is one small file. None of them changes a number: a doubt is a sentence with
its evidence, its likeliest cause and what to do.
"""

import xarray as xr

from softfinger.doubts.bridged import doubt_bridged
from softfinger.doubts.camera import doubt_camera
from softfinger.doubts.copies import doubt_copies
from softfinger.doubts.covariates import doubt_covariates
from softfinger.doubts.coverage import doubt_coverage
from softfinger.doubts.dimension import doubt_dimension
from softfinger.doubts.doubt import Doubt
from softfinger.doubts.features import describe_trials
from softfinger.doubts.files import doubt_files
from softfinger.doubts.joints import doubt_joints
from softfinger.doubts.rest import doubt_rest
from softfinger.doubts.scale import doubt_scale
from softfinger.doubts.sensors import doubt_sensors
from softfinger.doubts.table import tabulate_doubts
from softfinger.doubts.timing import doubt_timing
from softfinger.doubts.together import doubt_together
from softfinger.doubts.zeroed import doubt_zeroed

__all__ = ["Doubt", "doubt_camera", "doubt_files", "find_doubts", "tabulate_doubts"]


def find_doubts(angles: xr.Dataset) -> list[Doubt]:
    """List what looks wrong in a campaign's `angles`."""
    trials = describe_trials(angles)
    names = [trial.name for trial in trials]
    finger = "motion_unit" not in angles.attrs
    covariates = angles["covariate"].values.astype(str).tolist()
    return [
        *doubt_dimension(trials, angles),
        *doubt_timing(trials, angles["started_at"].to_numpy()),
        *doubt_together(trials),
        *doubt_coverage(trials),
        *doubt_joints(trials),
        *(doubt_rest(trials) if finger else ()),
        *doubt_zeroed(trials),
        *doubt_scale(trials),
        *doubt_sensors(trials, rotates=finger),
        *doubt_bridged(trials),
        *doubt_copies(trials),
        *doubt_covariates(names, covariates, angles["covariate_value"].to_numpy()),
    ]
