import math
from dataclasses import replace

import pytest

from ur.tui.screen.half_blocks import Glyph
from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.glyphs import draw_glyphs, scale_bar
from ur_nodes.teleop.map_view.palette import DARK
from ur_nodes.teleop.map_view.picture import Viewport


def rows_of(glyphs: list[Glyph], view: Viewport) -> list[str]:
    rows = [[" "] * view.width for _ in range(view.height // 2)]
    for glyph in glyphs:
        rows[glyph.row][glyph.column] = glyph.text
    return ["".join(row).rstrip() for row in rows]


def test_robot_and_goal_are_arrows_from_afar() -> None:
    view = Viewport(0.0, 0.0, 0.5, 20, 20)
    goal = GoalReport(1, Pose2(2.0, 0.0, math.pi / 2), LastGoalState.DRIVING)
    snapshot = RobotSnapshot(pose=Pose2(0.1, -0.1, math.pi), goal=goal)
    glyphs = draw_glyphs(snapshot, {}, None, view, DARK)
    assert [(g.column, g.row, g.text) for g in glyphs] == [(14, 5, "↑"), (10, 5, "←")]
    over = replace(snapshot, goal=replace(goal, state=LastGoalState.REACHED))
    assert [g.text for g in draw_glyphs(over, {}, None, view, DARK)] == ["←"]


def test_robot_to_scale_is_no_character() -> None:
    view = Viewport(0.0, 0.0, 0.02, 60, 60)
    assert not draw_glyphs(RobotSnapshot(pose=Pose2(0.0, 0.0, 0.0)), {}, None, view, DARK)


def test_name_of_a_waypoint_is_right_of_its_dot() -> None:
    view = Viewport(0.0, 0.0, 1.0, 20, 10)
    assert rows_of(draw_glyphs(RobotSnapshot(), {"kitchen": Pose2(2.0, 0.0, 0.0)}, None, view, DARK), view)[2] == (
        " " * 12 + "•kitchen"
    )


def test_name_at_the_right_edge_is_left_of_its_dot() -> None:
    view = Viewport(0.0, 0.0, 1.0, 10, 10)
    glyphs = draw_glyphs(RobotSnapshot(), {"kitchen": Pose2(2.0, 0.0, 0.0)}, None, view, DARK)
    assert rows_of(glyphs, view)[2] == "kitchen•"


def test_name_without_room_is_left_out_and_its_dot_stays() -> None:
    view = Viewport(0.0, 0.0, 1.0, 6, 10)
    glyphs = draw_glyphs(RobotSnapshot(), {"kitchen": Pose2(2.0, 0.0, 0.0)}, None, view, DARK)
    assert [glyph.text for glyph in glyphs] == ["•"]
    assert not draw_glyphs(RobotSnapshot(), {"far": Pose2(50.0, 0.0, 0.0)}, None, view, DARK)


@pytest.mark.parametrize("scale", [0.5, 0.03], ids=["arrow", "disc"])
def test_name_is_beside_the_robot_not_over_it(scale: float) -> None:
    view = Viewport(0.0, 0.0, scale, 60, 40)
    snapshot = RobotSnapshot(pose=Pose2(0.0, 0.0, 0.0))
    glyphs = draw_glyphs(snapshot, {"kitchen": Pose2(0.0, 0.0, 0.0)}, None, view, DARK)
    letters = [glyph for glyph in glyphs if glyph.text not in "•→"]
    assert "".join(glyph.text for glyph in letters) == "kitchen"
    for glyph in letters:
        x, y = view.to_map(glyph.column + 0.5, glyph.row * 2 + 1.0)
        assert max(abs(x), abs(y)) > 0.2


def test_names_do_not_cover_one_another() -> None:
    view = Viewport(0.0, 0.0, 1.0, 30, 20)
    places = {"kitchen": Pose2(0.0, 0.0, 0.0), "door": Pose2(2.0, 0.0, 0.0), "sofa": Pose2(1.0, 1.0, 0.0)}
    shown = "\n".join(rows_of(draw_glyphs(RobotSnapshot(), places, None, view, DARK), view))
    assert all(name in shown for name in places)


@pytest.mark.parametrize(
    ("scale", "bar"),
    [
        (0.05, "├────────┤ 0.5 m"),
        (0.26, "├──────┤ 2 m"),
        (1.0, "├───┤ 5 m"),
        (0.1, "├───┤ 0.5 m"),
        (3.0, "├─────┤ 20 m"),
    ],
)
def test_scale_bar_is_as_long_as_it_says(scale: float, bar: str) -> None:
    view = Viewport(0.0, 0.0, scale, 80, 40)
    row = rows_of(scale_bar(view, DARK), view)[-1]
    assert row == f" {bar}"
    metres = float(bar.split()[1])
    assert bar.index("┤") + 1 == pytest.approx(metres / scale, abs=0.5)


def test_small_map_has_no_scale_bar() -> None:
    assert not scale_bar(Viewport(0.0, 0.0, 0.05, 20, 6), DARK)
