"""Markers and frames of a 3D view, which may be anything."""

from __future__ import annotations

import math
from types import SimpleNamespace as Value
from typing import Any

from ur_nodes.web.scene.frames import FrameTree
from ur_nodes.web.scene.markers import Markers


def vector(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Any:
    return Value(x=x, y=y, z=z)


def turn(w: float = 1.0) -> Any:
    return Value(x=0.0, y=0.0, z=0.0, w=w)


def marker(number: int = 0, life: float = 0.0, action: int = 0, **more: Any) -> Any:
    return Value(
        header=Value(frame_id="/map"),
        ns="a",
        id=number,
        action=action,
        type=more.get("type", 1),
        pose=Value(position=vector(more.get("x", 0.0)), orientation=turn()),
        scale=vector(1.0, 1.0, 1.0),
        color=Value(r=1.0, g=0.0, b=0.0, a=1.0),
        lifetime=Value(to_sec=lambda: life),
        points=more.get("points", []),
        colors=[],
        text=more.get("text", ""),
    )


def test_markers_are_added_deleted_and_outlive_themselves() -> None:
    found = Markers()
    found.take(marker(1), 0.0)
    found.take(marker(2, life=1.0), 0.0)
    assert len(found.describe(0.5)) == 2
    assert found.expires(1.5)
    assert len(found.describe(1.5)) == 1
    found.take(marker(1, action=2), 2.0)
    assert found.describe(2.0) == []
    found.take(marker(1), 3.0)
    found.take(marker(action=3), 3.0)
    assert found.describe(3.0) == []


def test_markers_that_are_malformed_are_left_out_and_all_are_bounded() -> None:
    found = Markers()
    found.take(marker(1, x=math.nan), 0.0)
    found.take(marker(2, type=99), 0.0)
    found.take(marker(3, type=4, points=[vector(math.inf)]), 0.0)
    assert found.describe(0.0) == []
    for number in range(1000):
        found.take(marker(number, type=4, points=[vector(1.0)] * 10_000), 0.0)
    shown = found.describe(0.0)
    assert sum(len(each["points"]) for each in shown) <= 3 * 12_000
    found.take(marker(3, type=9, text="\x1b" + "x" * 5000), 0.0)
    assert len(found.describe(0.0)[-1].get("text", "")) <= 400


def transform(child: str, parent: str, x: float = 0.0, w: float = 1.0) -> Any:
    return Value(
        child_frame_id=child,
        header=Value(frame_id=parent),
        transform=Value(translation=vector(x), rotation=turn(w)),
    )


def test_frames_are_kept_while_they_are_heard_of() -> None:
    tree = FrameTree()
    tree.take(transform("/a", "map", 1.0), 0.0, fixed=False)
    tree.take(transform("b", "a"), 0.0, fixed=True)
    tree.take(transform("bad", "a", math.nan), 0.0, fixed=True)
    tree.take(transform("bad", "a", w=0.0), 0.0, fixed=True)
    tree.take(transform("bad", "bad"), 0.0, fixed=True)
    assert tree.describe(1.0) == [
        ["a", "map", 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ["b", "a", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    ]
    assert [each[0] for each in tree.describe(60.0)] == ["b"]
    for number in range(1000):
        tree.take(transform(f"f{number}", "a"), 0.0, fixed=True)
    assert len(tree.describe(0.0)) == 400
