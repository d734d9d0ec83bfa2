"""From video to markers and angles, with uncertainty."""

from softfinger.tracking.angles import compute_joint_angles
from softfinger.tracking.assemble import assemble_angles
from softfinger.tracking.track import track_trials, track_video

__all__ = ["assemble_angles", "compute_joint_angles", "track_trials", "track_video"]
