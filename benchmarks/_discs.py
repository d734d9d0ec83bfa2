"""Pictures of discs with known sub-pixel truth.

For tests and benchmarks. Discs are drawn by counting sub-pixels and blurring the fine picture:
nothing is shared with the profile that the fit believes in.
"""

import cv2
import numpy as np


def draw_disc(
    shape: tuple[int, int],
    centre: tuple[float, float],
    radius: float,
    blur: float,
    divisions: int = 20,
) -> np.ndarray:
    """A disc's share of each pixel's light, by supersampling.

    Parameters
    ----------
    shape : (rows, columns)
    centre : (x, y) [px]
        The centre of the top left pixel is (0, 0).
    radius : float [px]
    blur : float [px]
        Standard deviation of the optics' Gaussian blur; the pixel's own comes on top.

    Returns
    -------
    (row, column) in 0 … 1

    Examples
    --------
    A disc's light is its area:

    >>> round(float(draw_disc((40, 41), (20.3, 19.6), 8.0, 0.6).sum() / np.pi / 64), 3)
    1.0
    """
    picture = np.zeros(shape)
    reach = int(np.ceil(radius + 5.0 * blur + 2.0))
    left, top = round(centre[0]) - reach, round(centre[1]) - reach
    size = 2 * reach + 1
    fine = (np.arange(size * divisions) + 0.5) / divisions - 0.5
    inside = (fine[None] + left - centre[0]) ** 2 + (fine[:, None] + top - centre[1]) ** 2
    covered = (inside < radius**2).astype(np.float32)
    if blur > 0.0:
        covered = cv2.GaussianBlur(covered, (0, 0), blur * divisions)
    window = covered.reshape(size, divisions, size, divisions).mean(axis=(1, 3), dtype=float)
    rows = slice(max(0, top), min(shape[0], top + size))
    columns = slice(max(0, left), min(shape[1], left + size))
    picture[rows, columns] = window[
        rows.start - top : rows.stop - top, columns.start - left : columns.stop - left
    ]
    return picture


def expose(light: np.ndarray, noise_sd: float, rng: np.random.Generator) -> np.ndarray:
    """Picture in 8 bits with white camera noise.

    Returns
    -------
    uint8, of the shape of `light`
    """
    noisy = light + noise_sd * rng.standard_normal(light.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def compute_position_bound(
    centre: tuple[float, float], radius: float, blur: float, contrast: float, noise_sd: float
) -> float:
    r"""Smallest sd of an unbiased estimate of x.

    The Cramér–Rao bound of the rendered disc with contrast, radius, blur and level unknown too, in
    a window so wide that the slopes of the light cost nothing. The noise is that of the camera and
    of rounding, :math:`σ^2 + 1/12`. For a wide disc and an edge of spread S it approaches

    .. math:: σ_x ≥ \frac{σ}{|A|} \sqrt{\frac{2 S}{\sqrt{π} R}}.

    Parameters
    ----------
    centre : (x, y) [px]
        Only its fraction of a pixel matters.
    radius, blur : float [px]
    contrast, noise_sd : float
        In units of light.

    Returns
    -------
    float [px]

    Examples
    --------
    >>> bound = compute_position_bound((0.3, 0.1), 10.0, 0.6, 100.0, 4.0)
    >>> asymptotic = 0.04 * np.sqrt(2 * np.hypot(0.6, 12**-0.5) / np.pi**0.5 / 10.0)
    >>> bool(abs(bound / asymptotic - 1.0) < 0.02)
    True
    """
    half = int(np.ceil(2.0 * radius + 8.0))
    at = np.array([half + centre[0] % 1.0, half + centre[1] % 1.0, radius, blur])
    shape = (2 * half + 2, 2 * half + 2)

    def draw(changed: np.ndarray) -> np.ndarray:
        return draw_disc(shape, (changed[0], changed[1]), changed[2], changed[3], 30).ravel()

    columns = [draw(at), np.ones(shape[0] * shape[1])]
    for k, step in enumerate((0.1, 0.1, 0.1, 0.1 * blur)):
        if step > 0.0:
            off = step * np.eye(4)[k]
            columns.append(contrast * (draw(at + off) - draw(at - off)) / (2.0 * step))
    jacobian = np.stack(columns, axis=1)
    information = jacobian.T @ jacobian / (noise_sd**2 + 1.0 / 12.0)
    return float(np.sqrt(np.linalg.inv(information)[2, 2]))
