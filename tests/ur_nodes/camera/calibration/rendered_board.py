"""Pictures of a chessboard by a camera whose calibration is known."""

import math
from collections.abc import Iterator

import cv2
import numpy as np

from ur_nodes.camera.calibration.board import Board, Floats
from ur_nodes.camera.calibration.session import BoardView
from ur_nodes.pictures.decode import Pixels

WIDTH, HEIGHT = 640, 480
MATRIX = np.array([[540.0, 0.0, 332.0], [0.0, 537.0, 231.0], [0.0, 0.0, 1.0]])
DISTORTION = np.array([-0.12, 0.06, 0.001, -0.0008, 0.0])
_SAMPLES = 2  # of a pixel along each axis


class Studio:
    """Renders one board; the rays of the pixels are computed once."""

    def __init__(self, board: Board, seed: int = 0) -> None:
        self._board, self._random = board, np.random.default_rng(seed)
        offsets = (np.arange(WIDTH * _SAMPLES) + 0.5) / _SAMPLES - 0.5
        rows = (np.arange(HEIGHT * _SAMPLES) + 0.5) / _SAMPLES - 0.5
        pixels = np.stack(np.meshgrid(offsets, rows), axis=-1).reshape(-1, 1, 2)
        flat = cv2.undistortPoints(pixels, MATRIX, DISTORTION).reshape(-1, 2)
        self._rays = np.hstack([flat, np.ones((len(flat), 1))])

    def take(self, rotation: Floats, translation: Floats) -> Pixels:
        """A picture of the board; its centre is at `translation` (m) before the camera."""
        normal = rotation[:, 2]
        depth = (normal @ translation) / (self._rays @ normal)
        hit = (self._rays * depth[:, None] - translation) @ rotation
        edge = self._board.square
        column = hit[:, 0] / edge + (self._board.columns - 1) / 2.0
        row = hit[:, 1] / edge + (self._board.rows - 1) / 2.0
        on_board = (column > -1) & (column < self._board.columns) & (row > -1) & (row < self._board.rows)
        on_page = (column > -1.5) & (column < self._board.columns + 0.5) & (row > -1.5) & (row < self._board.rows + 0.5)
        black = (np.floor(column) + np.floor(row)).astype(int) % 2 == 0
        light = np.where(on_board, np.where(black, 25.0, 225.0), np.where(on_page, 225.0, 120.0))
        fine = light.reshape(HEIGHT, _SAMPLES, WIDTH, _SAMPLES).mean(axis=(1, 3))
        noisy = fine + self._random.normal(0.0, 2.0, fine.shape)
        grey = np.clip(noisy, 0, 255).astype(np.uint8)
        return np.repeat(grey[:, :, None], 3, axis=2)


def list_poses() -> Iterator[tuple[Floats, Floats]]:
    """Poses that cover the picture, tilted each way."""
    tilts = ((0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5), (0.35, 0.35))
    number = 0
    for y in (-0.1, 0.0, 0.1):
        for x in (-0.15, -0.05, 0.05, 0.15):
            pitch, yaw = tilts[number % len(tilts)]
            yield rotate(pitch, yaw, 0.1 * (number % 3)), np.array([x, y, 0.5])
            number += 1
    for pitch, yaw in (*tilts, (0.0, 0.0)):
        yield rotate(pitch, yaw, 0.3), np.array([0.0, 0.0, 0.35])


def rotate(pitch: float, yaw: float, roll: float) -> Floats:
    """Rotations in rad about x, then y, then z of the camera."""

    def turn(axis: int, angle: float) -> Floats:
        matrix = np.eye(3)
        a, b = (axis + 1) % 3, (axis + 2) % 3
        matrix[a, a] = matrix[b, b] = math.cos(angle)
        matrix[b, a], matrix[a, b] = math.sin(angle), -math.sin(angle)
        return matrix

    turned: Floats = turn(2, roll) @ turn(1, yaw) @ turn(0, pitch)
    return turned


def project_views(board: Board, noise: float = 0.1) -> list[BoardView]:
    """The views of those poses without pictures: corners are projected, with noise in pixels."""
    random, views = np.random.default_rng(1), []
    centred = board.points - board.points.mean(axis=0)
    for rotation, translation in list_poses():
        turn = cv2.Rodrigues(rotation)[0]
        corners = cv2.projectPoints(centred, turn, translation, MATRIX, DISTORTION)[0].reshape(-1, 2)
        views.append(BoardView(corners + random.normal(0.0, noise, corners.shape), WIDTH, HEIGHT))
    return views
