from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from softfinger.faults import Fault
from softfinger.tracking.picture import take_picture
from softfinger.tracking.track import track_video


@pytest.fixture
def pictures(rig):
    return [rig.draw(rig.place((0.05 * k, 0.03 * k))) for k in (0, 1, 2, 3, 2, 1, 0)]


@pytest.fixture
def tracked(rig, pictures):
    video = rig.film(pictures)
    found = track_video(video, rig.camera, rig.link_length)
    two = xr.concat([found, found], dim=xr.DataArray(["bad", "good"], dims="trial", name="trial"))
    markers = two.assign(set_aside_reason=("trial", ["no marker was found", ""]))
    trials = [SimpleNamespace(name=name, recording=video) for name in ("bad", "good")]
    return SimpleNamespace(trials=trials, camera=rig.camera), markers


def test_the_picture_is_the_most_bent_frame_of_the_first_used_trial(tracked, pictures):
    taken = take_picture(*tracked)
    assert (str(taken["trial"].item()), int(taken["frame"])) == ("good", 3)
    assert taken["picture"].dims == ("row", "column", "channel")
    grey = taken["picture"].to_numpy().astype(float).mean(axis=2)
    gaps = [
        np.abs(grey - np.squeeze(p).reshape(*grey.shape, -1).mean(axis=2)).mean() for p in pictures
    ]
    assert int(np.argmin(gaps)) == 3


def test_without_a_used_trial_there_is_no_picture(tracked):
    campaign, markers = tracked
    markers["set_aside_reason"][:] = "no marker was found"
    with pytest.raises(Fault, match="no trial of this batch was tracked"):
        take_picture(campaign, markers)
