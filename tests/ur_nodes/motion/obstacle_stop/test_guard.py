"""Velocities that are permitted before walls, bumpers and what no sensor sees."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.ur_nodes.motion.obstacle_stop.conftest import guard_of, load, scan_of, seeing

from ur.robot.base import Cliff, Cliffs
from ur_nodes.motion.obstacle_stop.guard import BLIND, Cause, make_guard
from ur_nodes.motion.obstacle_stop.obstacle_stop import contact_points, contact_topics, explain_frame, make_sight
from ur_nodes.motion.obstacle_stop.sight import Contact, SensorRanges, Sight, touch

FRONT = 0.10  # m from the lidar of stage to its front edge


def free(at: float) -> SensorRanges:
    return SensorRanges(np.full(360, math.inf), (0.12, 12.0), at, -math.pi, math.pi / 180.0)


def test_free_floor_permits_full_speed(sight: Sight) -> None:
    verdict = guard_of(seeing(sight, free(1.0))).permit(0.5, 1.0, 1.1)
    assert (verdict.forward, verdict.turn, verdict.cause) == (0.5, 1.0, None)


@pytest.mark.parametrize(
    ("clear", "least", "most"), [(1.0, 0.5, 0.5), (0.2, 0.15, 0.4), (0.1, 0.03, 0.25), (0.02, 0.0, 0.0)]
)
def test_nearer_walls_permit_less(sight: Sight, clear: float, least: float, most: float) -> None:
    verdict = guard_of(seeing(sight, scan_of(FRONT + clear, 1.0))).permit(0.5, 0.0, 1.0)
    assert least <= verdict.forward <= most
    if verdict.cause:
        assert verdict.cause.side == "ahead"
        assert verdict.cause.distance == pytest.approx(clear, abs=0.01)


def test_curve_slows_on_the_same_arc(sight: Sight) -> None:
    verdict = guard_of(seeing(sight, scan_of(FRONT + 0.15, 1.0))).permit(0.5, 0.5, 1.0)
    assert 0.0 < verdict.forward < 0.5
    assert verdict.turn == pytest.approx(verdict.forward)


def test_wall_beside_a_robot_stops_its_way_to_that_side_only(sight: Sight) -> None:
    ranges = np.full(360, math.inf)
    ranges[225:316] = sight.hull.corners[:, 1].max() / np.sin(np.radians(np.arange(45, 136))) + 0.02  # to the left
    guard = guard_of(seeing(sight, SensorRanges(ranges, (0.12, 12.0), 1.0, -math.pi, math.pi / 180.0)))
    verdict = guard.permit(0.0, 0.0, 1.0, 0.3)
    assert verdict.left == 0.0
    assert verdict.cause is not None
    assert verdict.cause.side == "on the left"
    assert guard.permit(0.0, 0.0, 1.0, -0.3).left == -0.3


def test_side_that_no_sensor_sees_is_driven_to_slowly(sight: Sight) -> None:
    blind = guard_of(sight).permit(0.3, 0.0, 9.0, 0.4)
    assert blind.left == pytest.approx(BLIND)
    assert blind.forward == pytest.approx(0.15)


def test_robot_at_a_wall_turns_and_backs_off(sight: Sight) -> None:
    guard = guard_of(seeing(sight, scan_of(FRONT + 0.02, 1.0)))
    assert guard.permit(0.5, 0.0, 1.0).forward == 0.0
    assert guard.permit(-0.5, 0.0, 1.0) == guard_of(seeing(sight, free(1.0))).permit(-0.5, 0.0, 1.0)
    assert guard.permit(0.0, 1.0, 1.0).turn == 0.0  # its corners would meet the wall


def test_robot_before_a_pole_turns_while_the_way_forward_is_blocked(sight: Sight) -> None:
    ranges = np.full(360, math.inf)
    ranges[180] = FRONT + 0.02
    guard = guard_of(seeing(sight, SensorRanges(ranges, (0.12, 12.0), 1.0, -math.pi, math.pi / 180.0)))
    both = guard.permit(0.5, 1.0, 1.0)
    assert both.forward == 0.0
    assert both.turn > 0.1
    assert both.cause is not None


def test_wall_alongside_does_not_slow(sight: Sight) -> None:
    beside = seeing(sight, scan_of(0.19 + 0.04, 1.0, toward=math.pi / 2.0))
    assert guard_of(beside).permit(0.5, 0.0, 1.0).forward == 0.5


def test_scan_that_stops_limits_the_speed_and_is_named(sight: Sight) -> None:
    guard = guard_of(seeing(sight, free(1.0)))
    assert guard.permit(0.5, 0.0, 1.4).cause is None
    verdict = guard.permit(0.5, 0.0, 1.7)
    assert verdict.forward == pytest.approx(BLIND)
    assert verdict.cause is not None
    assert (verdict.cause.kind, verdict.cause.name) == ("silent", "scan")
    assert verdict.cause.age == pytest.approx(0.7)
    assert guard_of(sight).permit(0.5, 0.0, 9.0).cause == Cause("silent", "ahead", name="scan", age=math.inf)
    assert guard_of(sight).permit(0.1, 0.0, 9.0) == guard_of(sight).permit(0.1, 0.0, 1.0)


def test_last_points_of_a_scan_that_stopped_still_stop(sight: Sight) -> None:
    guard = guard_of(seeing(sight, scan_of(FRONT + 0.03, 1.0)))
    assert guard.permit(0.5, 0.0, 2.0).forward == 0.0


def test_robot_drives_slowly_to_where_no_sensor_looks() -> None:
    sight = make_sight(load("magni"))
    for number in range(len(sight.sensors)):
        sight = seeing(sight, SensorRanges(np.array([math.inf]), (0.05, 4.0), 1.0, cone=0.436), number)
    guard = guard_of(sight, "magni")
    assert guard.permit(0.5, 0.0, 1.0).cause is None
    back = guard.permit(-0.5, 0.5, 1.0)
    assert back.forward == pytest.approx(-BLIND)
    assert back.turn == pytest.approx(BLIND)
    assert back.cause == Cause("unseen", "behind")
    assert guard.permit(0.0, 1.0, 1.0).turn == 1.0


@pytest.mark.parametrize("name", ["stage", "botvac", "botvac/xv11", "magni", "magni/lidar", "loki"])
def test_every_base_sees_what_is_ahead(name: str) -> None:
    sensors = make_sight(load(name)).sensors
    assert np.any([sensor.views["ahead"] for sensor in sensors], axis=0).mean() >= 0.9
    seen_behind = np.any([sensor.views["behind"] for sensor in sensors], axis=0).mean()
    assert bool(seen_behind >= 0.9) is (name != "magni")


def test_pressed_bumper_stops_towards_it_and_lets_back_off() -> None:
    base = load("stage")
    sight = seeing(make_sight(base), free(1.0))
    front: tuple[Contact, str] = ("bumper", "front")
    guard = make_guard(touch(sight, front, contact_points(base, sight.hull, front)), base.limits, 0.11)
    verdict = guard.permit(0.5, 0.0, 1.0)
    assert verdict.forward == 0.0
    assert verdict.cause == Cause("bumper", "ahead", 0.0, "front")
    assert guard.permit(-0.5, 0.0, 1.0).forward == -0.5


@pytest.mark.parametrize("name", ["botvac", "botvac/botvac50", "botvac/xv11"])
@pytest.mark.parametrize(("side", "left"), [("left", 1.0), ("right", -1.0)])
def test_cliff_stops_towards_it_and_lets_back_off(name: str, side: str, left: float) -> None:
    base = load(name)
    sight = seeing(make_sight(base), free(1.0))
    guard = make_guard(touch(sight, ("cliff", side), contact_points(base, sight.hull, ("cliff", side))), base.limits, 0)
    for turn in (-0.5, 0.0, 0.5):
        verdict = guard.permit(0.3, turn, 1.0)
        assert verdict.forward == 0.0
        assert verdict.cause is not None
        assert (verdict.cause.kind, verdict.cause.name) == ("cliff", side)
    assert guard.permit(-0.3, 0.0, 1.0).forward == -0.3
    assert guard.permit(-0.3, -0.3 * left, 1.0).forward == -0.3


def test_bumper_and_cliff_sensor_of_one_name_are_told_apart() -> None:
    base = replace(load("stage"), cliffs=Cliffs("cliff", (Cliff("front", (0.15, 0.0, 0.02)),)))
    assert contact_topics(base)["bumper", "front"] == "bumper/front"
    assert contact_topics(base)["cliff", "front"] == "cliff/front"
    sight = make_sight(base)
    both: list[tuple[Contact, str]] = [("bumper", "front"), ("cliff", "front")]
    for contact in both:
        sight = touch(sight, contact, contact_points(base, sight.hull, contact))
    assert list(touch(sight, both[0], None).touched) == both[1:]


def test_ranges_of_an_unknown_sonar_are_explained() -> None:
    magni = load("magni")
    assert magni.sonars
    assert explain_frame(magni, magni.sonars.at[0].frame) == ""
    warning = explain_frame(magni, "\x1b[2J" + 500 * "x")
    assert warning.startswith("the obstacle stop ignores ranges of ")
    assert magni.sonars.at[0].frame in warning
    assert "\x1b" not in warning
    assert len(warning) < 300


def test_tight_passage_is_crept_through(sight: Sight) -> None:
    """1.5 cm of room on either side: less than the margin."""
    angles = -np.pi + np.arange(360) * np.pi / 180.0
    aside = np.abs(np.sin(angles))
    ranges = np.where(aside > 0.05, 0.205 / np.maximum(aside, 0.05), np.inf)
    verdict = guard_of(seeing(sight, SensorRanges(ranges, (0.12, 12.0), 1.0, -np.pi, np.pi / 180.0))).permit(
        0.5, 0.0, 1.0
    )
    assert 0.05 <= verdict.forward <= 0.1


def test_zero_stays_zero(sight: Sight) -> None:
    verdict = guard_of(seeing(sight, scan_of(FRONT, 1.0))).permit(0.0, 0.0, 1.0)
    assert (verdict.forward, verdict.turn) == (0.0, 0.0)
