import json
import math
import struct
import zlib

import pytest

from ur.web.server.viewers import FrameQueue
from ur.web.wire.frames import (
    TILE,
    GridFrame,
    Kind,
    Layer,
    PoseSample,
    generation_of,
    grid_frame,
    json_frame,
    key_of,
    points_frame,
    pose_frame,
    tile_frame,
)

GRID = GridFrame(3, 0.05, (-1.0, 2.0, 0.5), -4, 7, 300, 200)


def test_frames_of_a_key_say_which_it_is() -> None:
    assert key_of(tile_frame(Layer.MAP, 3, -2, 5, bytes(TILE * TILE))) == (Kind.TILE, Layer.MAP, -2, 5)
    assert key_of(pose_frame(PoseSample())) == (Kind.POSE, 0, 0, 0)
    with pytest.raises(ValueError, match="expected at least 6"):
        key_of(b"\0\0")


def test_points_keep_five_millimetres_and_drop_what_is_not_finite() -> None:
    points = [(10.0, -3.0), (math.inf, 0.0), (12.345, -3.21), (math.nan, 1.0)]
    frame = points_frame(Layer.SCAN, points)
    assert struct.unpack_from("<2f", frame, 6) == (10.0, -3.0)
    assert struct.unpack_from("<4h", frame, 14) == (0, 0, 469, -42)
    assert len(points_frame(Layer.SCAN, [])) == 14


def test_points_far_from_the_first_are_clipped_and_nothing_overflows() -> None:
    assert struct.unpack_from("<4h", points_frame(Layer.PLAN, [(0.0, 0.0), (1e6, -1e6)]), 14) == (0, 0, 32767, -32768)


@pytest.mark.parametrize("far", [1e39, -1e300, 1.7e308])
def test_numbers_beyond_32_bits_are_bounded_instead_of_refused(far: float) -> None:
    pose = struct.unpack_from("<7f", pose_frame(PoseSample(far, -far, far, age=math.inf)), 6)
    assert all(math.isfinite(each) for each in pose[:5])
    assert pose[5] == math.inf
    assert len(points_frame(Layer.PARTICLES, [(far, far), (-far, 0.0), (1.0, 2.0)])) == 14 + 12
    grid = GridFrame(1, far, (far, far, 0.0), round(far), -round(far), 10, 10)
    assert len(grid_frame(Layer.MAP, grid)) == len(grid_frame(Layer.MAP, GRID))
    with pytest.raises(OverflowError):
        struct.pack("<f", far)


def test_tiles_and_grids_carry_their_generation() -> None:
    cells = bytes(range(256)) * TILE
    tile = tile_frame(Layer.MAP, 3, 0, 1, cells)
    assert generation_of(tile) == generation_of(grid_frame(Layer.MAP, GRID)) == 3
    assert zlib.decompress(tile[10:]) == cells
    with pytest.raises(ValueError, match="tile of 3 cells"):
        tile_frame(Layer.MAP, 3, 0, 1, b"abc")


def test_json_frames_hold_any_letters() -> None:
    assert json.loads(json_frame(Kind.STATE, {"name": "Jörg"})[6:]) == {"name": "Jörg"}


def test_newer_frames_replace_older_ones_and_small_ones_go_first() -> None:
    frames = FrameQueue()
    tile, pose = tile_frame(Layer.MAP, 3, 0, 0, bytes(TILE * TILE)), pose_frame(PoseSample(x=2.0))
    for each in (tile, pose_frame(PoseSample(x=1.0)), pose):
        frames.put(each)
    assert (frames.pop(), frames.pop(), frames.pop()) == (pose, tile, None)


def test_another_map_drops_the_tiles_of_the_one_before() -> None:
    frames = FrameQueue()
    for each in (
        grid_frame(Layer.MAP, GRID),
        tile_frame(Layer.MAP, 2, 0, 0, bytes(TILE * TILE)),
        tile_frame(Layer.MAP, 3, 1, 0, bytes(TILE * TILE)),
    ):
        frames.put(each)
    frames.put(grid_frame(Layer.MAP, GRID))
    assert [key_of(each)[2] for each in frames if key_of(each)[0] == Kind.TILE] == [1]
