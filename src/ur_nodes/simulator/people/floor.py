"""The floor for simulated people: free positions, destinations, and routes between them."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ur.source.diagnostic import user_error
from ur.worlds.world_file import Box, WorldModel
from ur_nodes.simulator.mujoco_model import PERSON_RADIUS

Floats = NDArray[np.float64]

_ROOM = 0.06  # m between a person and a wall
_CELL = 0.1  # m, about
_SIDE = 15.0  # m: people stay within a square of twice this side about the start
_PLACES = 10  # that people go to
_DOORS = 5  # narrow places in which they stop
_DOOR_ROOMS = (0.3, 0.56)  # m from the middle of a narrow place to the nearest wall
_APART = 1.5  # m between two places
_CANDIDATES = 400
_TOGETHER = 12  # points of a route that are looked at together


class WalkableFloor:
    """Cells of about 0.1 m around the start of a world, in the map frame. The same seed gives the same destinations."""

    def __init__(self, world: WorldModel, random: np.random.Generator) -> None:
        """Raises UserError when there is no floor for people."""
        from scipy import ndimage  # for worlds with people only: it takes 40 MB

        plan = world.floor_plan
        stride = max(1, round(_CELL / plan.resolution))
        self._origin, self._side = plan.origin, stride * plan.resolution
        start = plan.cells_of_points(np.array(world.start[:2]))
        reach = math.ceil(_SIDE / plan.resolution)
        low = np.maximum(start - reach, 0) // stride * stride
        high = np.minimum(start + reach, plan.shape)
        self._low = low // stride
        blocked = plan.values[low[0] : high[0], low[1] : high[1]] != 0
        cells = np.moveaxis(np.indices(blocked.shape), 0, -1) + low
        points = plan.points_of_cells(cells)
        for box in (*world.boxes, *world.obstacles):
            blocked |= _is_below(box, points)
        blocked = np.pad(blocked, 1, constant_values=True)
        rooms = ndimage.distance_transform_edt(~blocked)[1:-1, 1:-1] * plan.resolution
        middle = stride // 2
        self._rooms: Floats = rooms[middle::stride, middle::stride]
        pieces, _ = ndimage.label(self._rooms >= PERSON_RADIUS + _ROOM, np.ones((3, 3)))
        self._free = _join(pieces, start // stride - self._low)
        if not self._free.any():
            raise user_error("people: the world has no floor that they fit on near its start", rule="not-free")
        self._corner, self._size, self._rows = tuple(self._low.tolist()), self._free.shape, self._free.tolist()
        self._axis = math.cos(plan.origin[2]), math.sin(plan.origin[2])
        self._numbers = np.full(self._free.shape, -1)
        self._numbers[self._free] = np.arange(int(self._free.sum()))
        self._cells: NDArray[np.intp] = np.argwhere(self._free)
        places = self._spread(np.arange(len(self._cells)), _PLACES, random)
        self.rooms = len(places)  # the places after as many are narrow
        self._ends = np.concatenate(
            (places, self._spread(self._narrow(ndimage.maximum_filter(self._rooms, 3)), _DOORS, random))
        )
        self._trees = self._grow_trees()

    @property
    def ends(self) -> Floats:
        """The points (n, 2) of all places, m."""
        return self._points(self._ends)

    def is_free(self, points: Floats) -> NDArray[np.bool_]:
        """Mark the points (n, 2) at which a person fits."""
        rows, columns = self._cells_of(points)
        height, width = self._free.shape
        inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
        found: NDArray[np.bool_] = inside & self._free[np.where(inside, rows, 0), np.where(inside, columns, 0)]
        return found

    def fits(self, x: float, y: float) -> bool:
        """Return whether a person fits at a point; as `is_free`, for one point."""
        x, y = x - self._origin[0], y - self._origin[1]
        along, across = self._axis[0] * x + self._axis[1] * y, self._axis[0] * y - self._axis[1] * x
        row, column = (
            math.floor(across / self._side) - self._corner[0],
            math.floor(along / self._side) - self._corner[1],
        )
        inside = 0 <= row < self._size[0] and 0 <= column < self._size[1]
        return inside and bool(self._rows[row][column])

    def draw(self, count: int, away_from: Floats, random: np.random.Generator) -> Floats:
        """Draw points (count, 2) where people fit, apart from each other and from given points (n, 2) if possible."""
        chosen: list[NDArray[np.float64]] = []
        order = self._points(random.permutation(len(self._cells)))
        for room in (1.5, 0.8, 0.0):
            for point in order[:_CANDIDATES]:
                if len(chosen) == count:
                    break
                near = np.concatenate((away_from, np.reshape(chosen, (-1, 2))))
                if not len(near) or np.hypot(*(near - point).T).min() > room:
                    chosen.append(point)
        return np.reshape(chosen[:count], (-1, 2))

    def route(self, start: Floats, end: int) -> Floats:
        """Return the corners (n, 2) of the route from a point to the place with a number, which is the last corner."""
        rows, columns = self._cells_of(start[None])
        height, width = self._free.shape
        cell = (int(np.clip(rows[0], 0, height - 1)), int(np.clip(columns[0], 0, width - 1)))
        number = int(self._numbers[cell])
        if number < 0:  # pushed aside: to the nearest cell first
            number = int(np.argmin(((self._cells - cell) ** 2).sum(axis=1)))
        path = [number]
        before = self._trees[end]
        while path[-1] != self._ends[end] and before[path[-1]] >= 0:
            path.append(int(before[path[-1]]))
        return self._pulled(self._points(np.array(path)))

    def _grow_trees(self) -> NDArray[np.int32]:
        """Return for each place and cell the next cell on the route to the place; negative at the place itself."""
        from scipy import sparse
        from scipy.sparse.csgraph import dijkstra

        rows, columns = self._cells.T
        parts = []
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            r, c = rows + down, columns + right
            inside = (r < self._free.shape[0]) & (c >= 0) & (c < self._free.shape[1])
            to = np.where(inside, self._numbers[np.where(inside, r, 0), np.where(inside, c, 0)], -1)
            kept = np.flatnonzero(to >= 0)
            # Away from walls where there is room, as people walk.
            tight = 1.0 + 0.15 / np.maximum(self._rooms[rows[kept], columns[kept]], 0.1)
            parts.append((kept, to[kept], math.hypot(down, right) * tight))
        begins, ends, lengths = (np.concatenate(each) for each in zip(*parts, strict=True))
        graph = sparse.csr_matrix((lengths, (begins, ends)), shape=(len(self._cells),) * 2)
        _, before = dijkstra(graph, directed=False, indices=self._ends, return_predecessors=True)
        found: NDArray[np.int32] = before
        return found

    def _pulled(self, points: Floats) -> Floats:
        """Leave out points whose neighbours see each other."""
        corners, here = [points[0]], 0
        while here < len(points) - 1:
            step = 1
            while following := list(points[here + step + 1 : here + step + 1 + _TOGETHER]):
                seen = self._count_seen(points[here], following)
                step += seen
                if seen < len(following):
                    break
            here += step
            corners.append(points[here])
        return np.array(corners)

    def _count_seen(self, here: Floats, others: list[Floats]) -> int:
        """Count the points before the first to which no straight line leads over free floor."""
        counts = [max(2, math.ceil(math.dist(here, other) / (0.5 * self._side))) for other in others]
        lines = [here + _spread_shares(count) * (other - here) for count, other in zip(counts, others, strict=True)]
        seen = np.logical_and.reduceat(self.is_free(np.concatenate(lines)), np.cumsum([0, *counts[:-1]]))
        return len(others) if seen.all() else int(np.argmin(seen))

    def _narrow(self, widest: Floats) -> NDArray[np.intp]:
        """Return the numbers of the cells in the middle of narrow passages; `widest` is the most room around each."""
        ridge = (self._rooms == widest) & self._free
        low, high = _DOOR_ROOMS
        found: NDArray[np.intp] = self._numbers[ridge & (self._rooms >= low) & (self._rooms <= high)]
        return found

    def _spread(self, numbers: NDArray[np.intp], count: int, random: np.random.Generator) -> NDArray[np.intp]:
        """Choose up to this many cells, apart from each other; those with the most room first."""
        order = random.permutation(numbers)[:_CANDIDATES]
        points = self._points(order)
        chosen: list[int] = []
        for number in range(len(order)):
            if all(math.dist(points[number], points[other]) > _APART for other in chosen):
                chosen.append(number)
            if len(chosen) == count:
                break
        return order[chosen]

    def _points(self, numbers: NDArray[np.intp]) -> Floats:
        cells = self._cells[numbers] + self._low
        x, y, yaw = self._origin
        offsets = (cells[..., ::-1] + 0.5) * self._side
        c, s = math.cos(yaw), math.sin(yaw)
        points: Floats = offsets @ np.array(((c, s), (-s, c))) + (x, y)
        return points

    def _cells_of(self, points: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        x, y, yaw = self._origin
        c, s = math.cos(yaw), math.sin(yaw)
        offsets = (points - (x, y)) @ np.array(((c, -s), (s, c))) / self._side
        cells = np.floor(offsets).astype(np.intp)
        return cells[..., 1] - self._low[0], cells[..., 0] - self._low[1]


@lru_cache(maxsize=1000)
def _spread_shares(count: int) -> Floats:
    return np.linspace(0.0, 1.0, count)[:, None]


def _join(pieces: NDArray[np.int32], start: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return the cells of the piece of floor that is nearest to the start; pieces have numbers, walls 0."""
    cells = np.argwhere(pieces)
    if not len(cells):
        return pieces > 0
    nearest = cells[int(np.argmin(((cells - start) ** 2).sum(axis=1)))]
    joined: NDArray[np.bool_] = pieces == pieces[tuple(nearest)]
    return joined


def _is_below(box: Box, points: Floats) -> NDArray[np.bool_]:
    """Mark the points (..., 2) in the area of a box."""
    x, y, _, yaw = box.pose
    c, s = math.cos(yaw), math.sin(yaw)
    offsets = np.abs((points - (x, y)) @ np.array(((c, -s), (s, c))))
    below: NDArray[np.bool_] = (offsets[..., 0] <= box.size[0] / 2.0) & (offsets[..., 1] <= box.size[1] / 2.0)
    return below
