"""Keyframes and edges of a map as the values that `ur.maps.scan_file` stores, and back."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ur.maps.record import MapRecord
from ur.maps.scan_file import StoredGraph, StoredScan, read_graph, read_scans
from ur.source.diagnostic import UserError, error
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.scan import MapScan, restore_scan
from ur_nodes.slam.pose_graph.edge import Edge


def store_scan(scan: MapScan) -> StoredScan:
    """The fields of a scan that are stored."""
    return StoredScan(scan.hits, scan.numbers, scan.misses, scan.origin)


def store_graph(poses: Sequence[Pose2], edges: Sequence[Edge]) -> StoredGraph:
    """A pose graph as it is stored."""
    return StoredGraph(
        np.array(poses, np.float64).reshape(-1, 3),
        np.array([(each.before, each.after) for each in edges], np.int32).reshape(-1, 2),
        np.array([each.relative for each in edges], np.float64).reshape(-1, 3),
        np.array([each.covariance for each in edges], np.float64).reshape(-1, 3, 3),
        np.array([each.robust for each in edges], np.bool_),
    )


def load_scans(folder: Path, record: MapRecord) -> list[MapScan]:
    """Read the scans of a map. Raises UserError: a file is missing or damaged."""
    scans: list[MapScan] = []
    for name in record.scans:
        stored = read_scans(folder / name)
        scans += [restore_scan(each.hits, each.numbers, each.misses, each.origin) for each in stored]
    return scans


def load_poses(folder: Path, record: MapRecord) -> tuple[list[Pose2], list[Edge], list[MapScan]]:
    """Read keyframes, edges and scans of a map.

    Raises UserError: the map has none, for example because it was imported, or a file is missing or damaged.
    """
    if not record.graph or not record.scans:
        message = f"map {folder.name!r} has a picture only, expected scans"
        raise UserError(error(message, rule="no-scans", help="navigate on it with map:=, or make a new map"))
    stored = read_graph(folder / record.graph)
    scans = load_scans(folder, record)
    if len(scans) < len(stored.poses):
        message = f"map {folder.name!r} has {len(scans)} scans, expected {len(stored.poses)}"
        raise UserError(error(message, rule="bad-map", help="copy the map again, or make a new one"))
    poses = [Pose2(*map(float, pose)) for pose in stored.poses]
    edges = [
        Edge(int(before), int(after), Pose2(*map(float, relative)), covariance, bool(robust))
        for (before, after), relative, covariance, robust in zip(
            stored.ends, stored.relative, stored.covariances, stored.robust, strict=True
        )
    ]
    return poses, edges, scans[: len(poses)]
