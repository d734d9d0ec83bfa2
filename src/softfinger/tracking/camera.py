"""The lens: distortion, and intrinsics from a board."""

import cv2
import numpy as np

from softfinger.campaign import Camera


def undistort_array(position: np.ndarray, camera: Camera | None) -> np.ndarray:
    """Places as a lens without distortion shows them.

    Parameters
    ----------
    position : (…, 2) [px]
        NaN stays NaN.
    camera : Camera or None
        Without intrinsics the lens is taken for free of distortion.

    Returns
    -------
    (…, 2) [px]
    """
    if camera is None or camera.intrinsics is None or not any(camera.intrinsics.distortion):
        return position
    matrix = np.array(camera.intrinsics.matrix)
    distortion = np.array(camera.intrinsics.distortion)
    flat = np.ascontiguousarray(position.reshape(-1, 1, 2), float)
    seen = np.isfinite(flat).all(axis=(1, 2))
    straight = np.full_like(flat, np.nan)
    if seen.any():
        criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 50, 1e-10)
        straight[seen] = cv2.undistortImagePoints(
            flat[seen], matrix, distortion, arg1=criteria
        ).reshape(-1, 1, 2)
    return straight.reshape(position.shape)
