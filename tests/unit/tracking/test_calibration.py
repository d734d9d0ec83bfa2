import cv2
import numpy as np
import pytest

from softfinger.campaign import Camera
from softfinger.faults import Fault
from softfinger.tracking.calibration import Board, calibrate_camera
from softfinger.tracking.camera import undistort_array

MATRIX = np.array([[620.0, 0, 322.0], [0, 615.0, 236.0], [0, 0, 1]])
DISTORTION = np.array([-0.21, 0.08, 0.001, -0.0008, 0.0])
SIZE = (640, 480)
CHESS = Board("chessboard", 9, 6, 0.02)
PICTURES = {"chessboard": "chess_pictures", "charuco": "charuco_pictures"}
CHARUCO = Board("charuco", 8, 6, 0.02, 0.015)


def draw_board(board):
    """The board as a picture, 40 px a square, with a white border of one square."""
    if board.kind == "charuco":
        code = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary))
        size = (board.columns, board.rows)
        pattern = cv2.aruco.CharucoBoard(size, board.square_m, board.marker_m, code)
        flat = pattern.generateImage((40 * size[0], 40 * size[1]))
    else:
        row, column = np.indices((board.rows, board.columns))
        flat = np.kron((row + column) % 2 * 255, np.ones((40, 40))).astype(np.uint8)
    return np.pad(flat, 40, constant_values=255)


def film_board(board, folder, rng, count):
    """Pictures of the board at several slants through the lens; every pixel traced back."""
    flat = draw_board(board)
    column, row = np.meshgrid(np.arange(SIZE[0], dtype=float), np.arange(SIZE[1], dtype=float))
    pixels = np.stack([column, row], axis=-1).reshape(-1, 1, 2)
    rays = cv2.undistortPoints(pixels, MATRIX, DISTORTION).reshape(-1, 2)
    rays = np.column_stack([rays, np.ones(len(rays))])
    paths = []
    for k in range(count):
        turn, _ = cv2.Rodrigues(rng.uniform(-0.45, 0.45, 3) * (1, 1, 0.5))
        middle = np.array([board.columns, board.rows, 0.0]) * board.square_m / 2
        place = np.array([*rng.uniform(-0.02, 0.02, 2), 0.26]) - turn @ middle
        normal, depth = turn[:, 2], turn[:, 2] @ place
        points = rays * (depth / (rays @ normal))[:, None]
        flat_place = (points - place) @ turn
        pixel = (flat_place[:, :2] / board.square_m + 1.0) * 40.0 - 0.5
        seen = cv2.remap(
            flat,
            pixel.reshape(SIZE[1], SIZE[0], 2).astype(np.float32),
            None,
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=120,
        )
        paths.append(folder / f"board_{k}.png")
        cv2.imwrite(str(paths[-1]), cv2.GaussianBlur(seen, (0, 0), 0.7))
    return paths


@pytest.fixture(scope="module")
def chess_pictures(tmp_path_factory):
    return film_board(CHESS, tmp_path_factory.mktemp("chess"), np.random.default_rng(20), 7)


@pytest.fixture(scope="module")
def charuco_pictures(tmp_path_factory):
    return film_board(CHARUCO, tmp_path_factory.mktemp("charuco"), np.random.default_rng(20), 7)


@pytest.mark.parametrize("board", [CHESS, CHARUCO], ids=lambda b: b.kind)
def test_a_known_lens_is_found_from_its_pictures(board, request):
    found = calibrate_camera(request.getfixturevalue(PICTURES[board.kind]), board)
    assert found.rms < 0.25
    np.testing.assert_allclose(found.matrix, MATRIX, atol=6.0)
    np.testing.assert_allclose(found.distortion[0], DISTORTION[0], atol=0.03)
    assert found.size == SIZE
    assert (np.abs(np.diag(found.matrix)[:2] - [620.0, 615.0]) < 6 * found.focal_sd + 2.0).all()
    assert "intrinsics:" in found.to_yaml()


def test_pictures_without_a_board_are_set_aside_with_a_reason(chess_pictures, tmp_path):
    paths = chess_pictures[:5]
    for name in ("blank.png", "text.png"):
        paths.append(tmp_path / name)
    cv2.imwrite(str(paths[-2]), np.full((480, 640), 90, np.uint8))
    paths[-1].write_text("no picture")
    found = calibrate_camera(paths, CHESS)
    assert sorted(found.set_aside) == ["blank.png", "text.png"]
    assert "0 corners" in found.set_aside["blank.png"]


def test_too_few_pictures_and_mixed_sizes_are_refused(chess_pictures, tmp_path):
    paths = chess_pictures[:2]
    with pytest.raises(Fault, match="2 of 2 pictures show the 9 × 6 chessboard; expected at least"):
        calibrate_camera(paths, CHESS)
    cv2.imwrite(str(tmp_path / "odd.png"), np.zeros((100, 120), np.uint8))
    with pytest.raises(Fault, match=r"odd\.png: is 120 × 100 px"):
        calibrate_camera([*paths, tmp_path / "odd.png"], CHESS)


def test_a_charuco_board_needs_its_markers(charuco_pictures):
    with pytest.raises(Fault, match="needs marker_m"):
        calibrate_camera(charuco_pictures, Board("charuco", 8, 6, 0.02))


def build_camera(**scale):
    places = {"base": (-0.02, -0.01), "link_1": (0.01, 0.02)}
    return Camera(fps=30.0, markers=places, marker_diameter_m=0.004, **scale)


def test_undistorting_undoes_the_lens(rng):
    intrinsics = {"matrix": MATRIX.tolist(), "distortion": DISTORTION.tolist()}
    camera = build_camera(intrinsics=intrinsics)
    rays = rng.uniform(-0.45, 0.45, (7, 5, 2))
    straight = rays * np.diag(MATRIX)[:2] + MATRIX[:2, 2]
    ray3 = np.concatenate([rays, np.ones((7, 5, 1))], axis=-1).reshape(-1, 1, 3)
    bent = cv2.projectPoints(ray3, np.zeros(3), np.zeros(3), MATRIX, DISTORTION)[0].reshape(7, 5, 2)
    assert np.abs(bent - straight).max() > 5.0
    bent[2, 3] = np.nan
    found = undistort_array(bent, camera)
    assert np.isnan(found[2, 3]).all()
    found[2, 3] = straight[2, 3]
    np.testing.assert_allclose(found, straight, atol=1e-4)


def test_without_a_lens_places_stay(rng):
    places = rng.uniform(0, 400, (4, 3, 2))
    assert undistort_array(places, None) is places
    assert undistort_array(places, build_camera(metres_per_pixel=0.0002)) is places
