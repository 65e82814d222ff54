import json
import math

import pytest

from ur_nodes.motion.obstacle_stop.guard import Cause, GuardVerdict
from ur_nodes.motion.obstacle_stop.report import CLEAR, OFF, ObstacleReport, read_report, report_of, write_report

WANTED = (0.5, 0.0, 0.0)


@pytest.mark.parametrize(
    ("forward", "cause", "state", "text"),
    [
        (0.2, Cause("obstacle", "ahead", 0.42), "slowed", "slowed: obstacle 0.40 m ahead"),
        (0.0, Cause("obstacle", "on the left", 0.02), "stopped", "stopped: obstacle close on the left"),
        (0.0, Cause("bumper", "ahead", 0.0, "front"), "stopped", "stopped: bumper front pressed"),
        (0.0, Cause("cliff", "ahead", 0.0, "left"), "stopped", "stopped: cliff sensor left sees no floor"),
        (0.2, Cause("silent", "ahead", name="scan", age=0.52), "slowed", "slowed to 0.2 m/s: no scan for 0.5 s"),
        (0.2, Cause("silent", "ahead", name="scan", age=math.inf), "slowed", "slowed to 0.2 m/s: no scan yet"),
        (-0.2, Cause("unseen", "behind"), "slowed", "slowed to 0.2 m/s: no sensor sees what is behind"),
    ],
)
def test_report_names_what_is_in_the_way(forward: float, cause: Cause, state: str, text: str) -> None:
    report = report_of(GuardVerdict(forward, 0.0, cause), WANTED, (forward, 0.0, 0.0))
    assert (report.state, report.text) == (state, text)
    assert read_report(write_report(report)) == report


def test_nothing_is_reported_while_the_robot_is_hardly_slower_than_wanted() -> None:
    assert report_of(None, WANTED, WANTED) == CLEAR
    assert report_of(GuardVerdict(0.48, 0.0, Cause("obstacle", "ahead", 0.5)), WANTED, (0.48, 0.0, 0.0)) == CLEAR


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "null", '{"state": "fine"}', '{"state": []}', "[" * 5000, json.dumps({"text": "x"})]
)
def test_other_text_is_no_report(text: str) -> None:
    assert read_report(text) is None


def test_foreign_text_is_cut_and_made_printable() -> None:
    report = read_report(json.dumps({"state": "slowed", "text": "\x1b[2J" + "x" * 500}))
    assert report is not None
    assert report.text.startswith("\\x1b")
    assert len(report.text) == 120
    assert read_report('{"state": "off", "text": 5}') == ObstacleReport("off", "")
    assert read_report(write_report(OFF)) == OFF
