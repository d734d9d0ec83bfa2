"""A camera's intrinsics from a board's pictures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import cv2
import numpy as np

from softfinger.faults import Fault
from softfinger.gate.child import read_in_child
from softfinger.gate.pictures import decode_picture

FEWEST_PICTURES = 5
_FEWEST_CORNERS = 8


@dataclass(frozen=True)
class Board:
    """The board in the pictures.

    Parameters
    ----------
    kind : "chessboard" or "charuco"
    columns, rows : int
        Number of squares.
    square_m : float
        Side of a square.
    marker_m : float, optional
        Side of the coded markers of a ChArUco board.
    dictionary : str
        OpenCV's name of those markers' dictionary.
    """

    kind: Literal["chessboard", "charuco"]
    columns: int
    rows: int
    square_m: float
    marker_m: float | None = None
    dictionary: str = "DICT_4X4_50"


@dataclass(frozen=True)
class Calibration:
    """What the pictures show about the camera.

    ``matrix (3, 3) [px]`` and ``distortion (5,)`` are OpenCV's; ``rms [px]`` is what the corners
    deviate from the model; ``focal_sd [px]`` the standard deviation of the two focal lengths;
    ``set_aside`` maps pictures that show no board to the reason.
    """

    matrix: np.ndarray
    distortion: np.ndarray
    rms: float
    focal_sd: np.ndarray
    size: tuple[int, int]
    set_aside: Mapping[str, str]

    def to_yaml(self) -> str:
        """The lines for ``camera`` in ``campaign.yaml``."""
        rows = [[round(float(v), 4) for v in row] for row in self.matrix]
        distortion = [round(float(v), 6) for v in self.distortion]
        return f"intrinsics:\n  matrix: {rows}\n  distortion: {distortion}\n"


def calibrate_camera(pictures: Sequence[Path], board: Board) -> Calibration:
    """Estimate a camera's matrix and lens distortion.

    Parameters
    ----------
    pictures : sequence of Path
        At least five, of one size, the board at different slants and all over the picture.
    board : Board

    Raises
    ------
    Fault
        Fewer than five pictures show the board, or their sizes differ.
    """
    found, set_aside = [], {}
    size = None
    for path in pictures:
        try:
            picture = _read_picture(path)
        except Fault as fault:
            set_aside[path.name] = str(fault)
            continue
        size = size or picture.shape[::-1]
        if picture.shape[::-1] != size:
            raise Fault(
                f"{path.name}: is {picture.shape[1]} × {picture.shape[0]} px, the pictures before "
                f"{size[0]} × {size[1]} px; calibrate with pictures of one size"
            )
        places, corners = find_corners(picture, board)
        if len(corners) < _FEWEST_CORNERS:
            set_aside[path.name] = (
                f"{len(corners)} corners of the board were found; expected at least "
                f"{_FEWEST_CORNERS}"
            )
            continue
        found.append((places, corners))
    if len(found) < FEWEST_PICTURES:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in set_aside.items())
        raise Fault(
            f"{len(found)} of {len(pictures)} pictures show the {board.columns} × {board.rows} "
            f"{board.kind}; expected at least {FEWEST_PICTURES}; take more, and check the number "
            f"of squares{'. ' + reasons if reasons else ''}"
        )
    rms, matrix, distortion, _, _, sd, _, _ = cv2.calibrateCameraExtended(
        [places for places, _ in found], [corners for _, corners in found], size, None, None
    )
    return Calibration(matrix, distortion.ravel()[:5], rms, sd.ravel()[:2], size, set_aside)


def _read_picture(path: Path) -> np.ndarray:
    for described, content in read_in_child(decode_picture, str(path)):
        return content.reshape(described["shape"][:2])
    raise Fault("the picture cannot be decoded")


def find_corners(picture: np.ndarray, board: Board) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a board in a grey picture.

    Returns
    -------
    places (corner, 3) [m] on the board, corners (corner, 2) [px]
        Empty where the board is not seen.
    """
    if board.kind == "charuco":
        return _find_charuco(picture, board)
    inner = (board.columns - 1, board.rows - 1)
    seen, corners = cv2.findChessboardCornersSB(picture, inner, flags=cv2.CALIB_CB_ACCURACY)
    if not seen:
        return np.empty((0, 3), np.float32), np.empty((0, 2), np.float32)
    column, row = np.meshgrid(np.arange(inner[0]), np.arange(inner[1]))
    places = np.stack([column, row, 0 * row], axis=-1).reshape(-1, 3) * board.square_m
    return places.astype(np.float32), corners.reshape(-1, 2)


def _find_charuco(picture: np.ndarray, board: Board) -> tuple[np.ndarray, np.ndarray]:
    code = getattr(cv2.aruco, board.dictionary, None)
    if code is None or board.marker_m is None:
        raise Fault(
            f"a ChArUco board needs marker_m and a dictionary that OpenCV knows; got "
            f"{board.marker_m} and '{board.dictionary}'"
        )
    pattern = cv2.aruco.CharucoBoard(
        (board.columns, board.rows),
        board.square_m,
        board.marker_m,
        cv2.aruco.getPredefinedDictionary(code),
    )
    corners, ids, _, _ = cv2.aruco.CharucoDetector(pattern).detectBoard(picture)
    if ids is None or len(ids) == 0:
        return np.empty((0, 3), np.float32), np.empty((0, 2), np.float32)
    places = np.asarray(pattern.getChessboardCorners(), np.float32)[np.ravel(ids)]
    return places, np.asarray(corners, np.float32).reshape(-1, 2)
