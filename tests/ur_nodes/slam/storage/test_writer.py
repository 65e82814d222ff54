import multiprocessing
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.ur_nodes.slam.rooms import ROOM, scan_at

from ur.maps.record import MapEdit, MapRecord, read_record
from ur.maps.scan_file import CHUNK
from ur.source.diagnostic import UserError
from ur.source.replace import replace_file
from ur.worlds.map_file import read_map
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.map_state import Edge
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.storage.writer import MapWriter, load_poses, pause_before_next

SAVED_EVERY = 2  # keyframes, 2.5 s apart
GRID = Grid(np.zeros((4, 4), np.int8), 0.05, Pose2(-1.0, 0.0, 0.0))


def keyframes(count: int) -> tuple[list[Pose2], list[Edge], list[MapScan]]:
    poses = [Pose2(0.01 * n, 0.0, 0.1) for n in range(count)]
    edges = [Edge(n, n + 1, Pose2(0.01, 0.0, 0.0), np.eye(3) * 0.01, robust=n % 2 == 0) for n in range(count - 1)]
    return poses, edges, [scan_at(ROOM, Pose2(0.0, 0.0, 0.0))] * count


def test_written_map_is_read_back(tmp_path: Path) -> None:
    poses, edges, scans = keyframes(3)
    MapWriter(tmp_path, MapRecord(robot="stage")).write(GRID, poses, edges, scans)
    record = read_record(tmp_path)
    assert (record.robot, record.keyframes) == ("stage", 3)
    found_poses, found_edges, found_scans = load_poses(tmp_path, record)
    assert found_poses == poses
    assert [edge[:2] for edge in found_edges] == [(0, 1), (1, 2)]
    assert found_scans[1].hits == pytest.approx(scans[1].hits, abs=0.0011)
    assert len(found_scans[1].surface) == len(scans[1].surface)


def test_full_files_of_scans_are_written_once(tmp_path: Path) -> None:
    poses, edges, scans = keyframes(CHUNK + 2)
    first = MapWriter(tmp_path, MapRecord())
    first.write(GRID, poses[: CHUNK + 1], edges[:CHUNK], scans[: CHUNK + 1])
    full = first.record.scans[0]
    written = (tmp_path / full).stat().st_mtime_ns
    second = MapWriter(tmp_path, read_record(tmp_path))
    second.write(GRID, poses, edges, scans)
    assert second.record.scans[0] == full
    assert (tmp_path / full).stat().st_mtime_ns == written
    assert len(load_poses(tmp_path, read_record(tmp_path))[2]) == CHUNK + 2
    assert len(list(tmp_path.glob("*.npz"))) == 3


def test_full_file_is_written_again_when_a_scan_was_replaced(tmp_path: Path) -> None:
    poses, edges, scans = keyframes(2 * CHUNK + 1)
    writer = MapWriter(tmp_path, MapRecord())
    writer.write(GRID, poses, edges, scans)
    before = writer.record.scans
    scans[CHUNK + 3] = scan_at(ROOM, Pose2(0.5, 0.0, 0.0))
    writer.write(GRID, poses, edges, scans)
    after = writer.record.scans
    assert (after[0] == before[0], after[1] == before[1]) == (True, False)
    found = load_poses(tmp_path, read_record(tmp_path))[2]
    assert found[CHUNK + 3].hits == pytest.approx(scans[CHUNK + 3].hits, abs=0.0011)
    assert len(list(tmp_path.glob("*.npz"))) == 4


def test_power_that_fails_at_any_point_leaves_a_whole_map(tmp_path: Path) -> None:
    poses, edges, scans = keyframes(4)
    MapWriter(tmp_path, MapRecord()).write(GRID, poses[:2], edges[:1], scans[:2])
    points = 0

    def fail_at(last: int) -> Callable[..., None]:
        calls = 0

        def replace_or_fail(path: Path, content: str | bytes, **options: Any) -> None:
            nonlocal calls
            calls += 1
            if calls > last:
                raise OSError("the power failed")
            replace_file(path, content, **options)

        return replace_or_fail

    while True:
        try:
            MapWriter(tmp_path, read_record(tmp_path), fail_at(points)).write(GRID, poses, edges, scans)
        except OSError:  # noqa: PERF203 - one point after the other
            points += 1
            assert len(load_poses(tmp_path, read_record(tmp_path))[0]) == 2
            assert read_map(tmp_path / "map.yaml").width == 4
        else:
            break
    assert points == 5
    assert len(load_poses(tmp_path, read_record(tmp_path))[0]) == 4
    assert len(list(tmp_path.iterdir())) == 5


def test_pause_leaves_time_for_two_saves() -> None:
    assert pause_before_next(5.0, 0.0) == 5.0
    assert pause_before_next(5.0, 1.0) == 3.0
    assert pause_before_next(5.0, 4.0) == 4.0


def map_until_killed(folder: Path, turns: Connection) -> None:
    """Continue the map in a folder, a keyframe every 2.5 s of a clock of its own; announce each, and wait to go on."""
    writer = MapWriter(folder, read_record(folder) if (folder / "map.yaml").is_file() else MapRecord())
    count = writer.record.keyframes
    poses, edges, scans = keyframes(count + 100)
    for number in range(count + 1, len(scans)):
        turns.send(number)
        if number % SAVED_EVERY == 0:
            writer.write(GRID, poses[:number], edges[: number - 1], scans[:number])
        turns.recv()


def test_program_that_is_killed_at_twenty_points_loses_at_most_five_seconds_each_time(tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    context = multiprocessing.get_context("fork")
    made = kept = 0
    for _ in range(20):
        here, there = context.Pipe()
        process = context.Process(target=map_until_killed, args=(tmp_path, there))
        process.start()
        there.close()
        last = kept + int(random.integers(SAVED_EVERY, 3 * SAVED_EVERY))
        while (made := here.recv()) < last:
            here.send(None)
        time.sleep(float(random.uniform(0.0, 0.02)))  # to be anywhere in a save
        process.kill()
        process.join()
        here.close()
        record = read_record(tmp_path)
        poses, edges, scans = load_poses(tmp_path, record)
        assert len(poses) == len(scans) == len(edges) + 1
        assert read_map(tmp_path / "map.yaml").width == 4
        assert max(kept, made - SAVED_EVERY) <= len(poses) <= made
        kept = len(poses)
    MapWriter(tmp_path, read_record(tmp_path)).write(GRID, *keyframes(kept))
    assert len(list(tmp_path.glob("*.npz"))) == 1 + -(-kept // CHUNK)


def test_edits_are_drawn_into_each_picture(tmp_path: Path) -> None:
    poses, edges, scans = keyframes(2)
    record = MapRecord(edits=(MapEdit("wall", ((-1.0, 0.025), (1.0, 0.025))),))
    MapWriter(tmp_path, record).write(GRID, poses, edges, scans)
    assert read_map(tmp_path / "map.yaml").values[0].tolist() == [100] * 4


def test_map_without_scans_cannot_be_continued(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="has a picture only"):
        load_poses(tmp_path, MapRecord())
    MapWriter(tmp_path, MapRecord()).write(GRID, *keyframes(2))
    record = read_record(tmp_path)
    (tmp_path / record.scans[0]).unlink()
    with pytest.raises(UserError, match=r"scans_1\.npz' cannot be read: no such file"):
        load_poses(tmp_path, record)
