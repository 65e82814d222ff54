from typing import Any

import pytest
from bench.urdf_parts.bases import Made
from bench.urdf_parts.table import Row, render_row

DRIVE: dict[str, Any] = {
    "world": "maze",
    "goals": 10,
    "reached": 10,
    "path": 1.05,
    "final_error": 0.02,
    "collisions": 0,
    "breaches": [],
    "failures": [],
}


def test_robot_that_reaches_all_goals_is_good_and_shows_what_was_asked() -> None:
    row = Row("rover", Made(6, ("velocity", "a lidar")), DRIVE)
    assert row.is_good(driven=True)
    assert " ".join(render_row(row).split()) == "rover 6/8 ok maze 10/10 1.050 0.020 0 velocity, a lidar"


@pytest.mark.parametrize(
    ("made", "drive", "told"),
    [
        (Made(problem="no such file"), {}, "no such file"),
        (Made(8, findings="base.yaml:1:1: error: x"), DRIVE, "base.yaml:1:1"),
        (Made(8), {**DRIVE, "reached": 9, "failures": ["an obstacle blocks the way"]}, "9/10"),
        (Made(8), {**DRIVE, "collisions": 1}, "ok"),
        (Made(8), {**DRIVE, "breaches": ["/scan (sensor_msgs/LaserScan)"]}, "not published: /scan"),
        (Made(8), {"world": "maze", "problem": "no localised robot"}, "no localised robot"),
        (Made(8), {**DRIVE, "goals": 0, "reached": 0}, "0/0"),
    ],
)
def test_whatever_went_wrong_is_shown_and_is_not_good(made: Made, drive: dict[str, Any], told: str) -> None:
    row = Row("rover", made, drive)
    assert not row.is_good(driven=True)
    assert told in render_row(row)
