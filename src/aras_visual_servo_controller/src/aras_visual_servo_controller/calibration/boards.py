"""Boards: a chessboard or a grid of circles, its points in space and in an image."""

from math import cos, pi, sin
from typing import List, Optional, Tuple

import numpy as np

from aras_visual_servo import ParameterError

KINDS = ("chessboard", "circles")
#: Of a circle, relative to the distance between rows; and corners of the polygon that draws one.
RADIUS, CORNERS = 0.5, 48


class Board:
    """A calibration board in its plane z = 0: x along its rows, y along its columns, z into the board, as a viewer has
    x to the right and y down.

    Args:
        kind: "chessboard", or "circles": OpenCV's asymmetric grid, whose odd rows are shifted by half a distance.
        columns, rows: inner corners of the chessboard, or circles, along x and y; columns + rows of a chessboard is
        odd, so that it does not look the same when it is turned by half a turn.
        size_m: side of a square; or distance of neighbouring rows of circles [m].
    Raises: ParameterError.
    Attributes: points_m: (n, 3), row by row [m].
    """

    def __init__(self, kind: str, columns: int, rows: int, size_m: float):
        faults = []
        if kind not in KINDS:
            faults.append(f"board: found {kind}, allowed {' | '.join(KINDS)}")
        if columns < 3 or rows < 3:
            faults.append(f"columns, rows: found {columns}, {rows}, allowed >= 3")
        elif kind == "chessboard" and (columns + rows) % 2 == 0:
            faults.append(f"columns, rows: found {columns}, {rows}, allowed with a chessboard: their sum is odd, else "
                          "it looks the same after half a turn")
        if not 0.0 < size_m < 10.0:
            faults.append(f"size_m: found {size_m:g}, allowed > 0 and < 10")
        if faults:
            raise ParameterError(faults)
        self.kind, self.columns, self.rows, self.size_m = kind, columns, rows, size_m
        row, column = np.divmod(np.arange(columns * rows), columns)
        x = column if kind == "chessboard" else 2 * column + row % 2
        self.points_m = size_m * np.column_stack([x, row, np.zeros(len(row))])

    def find(self, image: np.ndarray) -> Optional[np.ndarray]:
        """Pixels of the points, (n, 2), in the order of points_m; None if the board is not wholly in view.

        Args: image: (h, w) or (h, w, 3), uint8.
        """
        import cv2
        grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
        if self.kind == "circles":
            found, points = cv2.findCirclesGrid(grey, (self.columns, self.rows), flags=cv2.CALIB_CB_ASYMMETRIC_GRID)
            return points.reshape(-1, 2).astype(float) if found else None
        found, points = cv2.findChessboardCornersSB(grey, (self.columns, self.rows), flags=cv2.CALIB_CB_ACCURACY)
        if not found:
            return None
        points = points.reshape(-1, 2).astype(float)
        return points if self._dark_first(grey, points) else points[::-1].copy()

    def _dark_first(self, grey, points):
        """Whether the square beside the first point is dark, as `outlines` has it; its neighbour is bright."""
        grid = points.reshape(self.rows, self.columns, 2)
        first, second = (grid[:2, k:k + 2].reshape(-1, 2).mean(axis=0) for k in (0, 1))
        level = [float(grey[int(round(y)), int(round(x))]) for x, y in (first, second)]
        return level[0] < level[1]

    def outlines(self) -> List[List[Tuple[float, float]]]:
        """Polygons, lists of (x, y), of what is dark on the board [m]: to print it (y down), or for a simulator."""
        size = self.size_m
        if self.kind == "circles":
            turn = [2.0 * pi * k / CORNERS for k in range(CORNERS)]
            return [[(x + RADIUS * size * cos(a), y + RADIUS * size * sin(a)) for a in turn]
                    for x, y, _ in self.points_m.tolist()]
        square = ((0, 0), (1, 0), (1, 1), (0, 1))
        return [[((i + x) * size, (j + y) * size) for x, y in square]
                for i in range(-1, self.columns) for j in range(-1, self.rows) if (i + j) % 2 == 0]
