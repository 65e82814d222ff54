"""Markers and frames of a 3D view, which may be anything."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.values import Marker, MarkerChange, Transform
from ur_nodes.web.scene.feed import FrameTree, ShownMarkers


def pose(x: float = 0.0, w: float = 1.0) -> Pose3:
    return Pose3(x, 0.0, 0.0, 0.0, 0.0, 0.0, w)


def marker(number: int = 0, life: float = 0.0, action: Any = "put", **more: Any) -> MarkerChange:
    shape, points = more.get("shape", "cube"), np.array(more.get("points", np.zeros((0, 3))))
    shown = Marker("a", number, shape, pose(more.get("x", 0.0)), (1.0,) * 3, (1.0, 0.0, 0.0, 1.0))
    return MarkerChange(0, "map", action, replace(shown, text=more.get("text", ""), points=points), life)


def test_markers_are_added_deleted_and_outlive_themselves() -> None:
    found = ShownMarkers()
    found.apply(marker(1), 0.0)
    found.apply(marker(2, life=1.0), 0.0)
    assert len(found.describe(0.5)) == 2
    assert found.expires(1.5)
    assert len(found.describe(1.5)) == 1
    found.apply(marker(1, action="delete"), 2.0)
    assert found.describe(2.0) == []
    found.apply(marker(1), 3.0)
    found.apply(marker(action="clear"), 3.0)
    assert found.describe(3.0) == []


def test_markers_that_are_malformed_are_left_out_and_all_are_bounded() -> None:
    found = ShownMarkers()
    found.apply(marker(1, x=math.nan), 0.0)
    found.apply(marker(3, shape="line_strip", points=[(math.inf, 0.0, 0.0)]), 0.0)
    assert found.describe(0.0) == []
    for number in range(1000):
        found.apply(marker(number, shape="line_strip", points=[(1.0, 0.0, 0.0)] * 10_000), 0.0)
    shown = found.describe(0.0)
    assert sum(len(each["points"]) for each in shown) <= 3 * 12_000
    found.apply(marker(3, shape="text", text="\x1b" + "x" * 5000), 0.0)
    assert len(found.describe(0.0)[-1].get("text", "")) <= 400


def transform(child: str, parent: str, x: float = 0.0, w: float = 1.0) -> Transform:
    return Transform(0, parent, child, pose(x, w))


def test_frames_are_kept_while_they_are_heard_of() -> None:
    tree = FrameTree()
    tree.add(transform("a", "map", 1.0), 0.0, fixed=False)
    tree.add(transform("b", "a"), 0.0, fixed=True)
    tree.add(transform("bad", "a", math.nan), 0.0, fixed=True)
    tree.add(transform("bad", "a", w=0.0), 0.0, fixed=True)
    tree.add(transform("bad", "bad"), 0.0, fixed=True)
    assert tree.describe(1.0) == [
        ["a", "map", 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ["b", "a", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    ]
    assert [each[0] for each in tree.describe(60.0)] == ["b"]
    for number in range(1000):
        tree.add(transform(f"f{number}", "a"), 0.0, fixed=True)
    assert len(tree.describe(0.0)) == 400
