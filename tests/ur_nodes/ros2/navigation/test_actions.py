"""Nav2's actions with programs of others: rclpy's client drives a node of ours, and its server is driven by one."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.ros2_messages import add_messages
from tests.ros2_session import PYTHON, Ros2Session

pytestmark = [pytest.mark.timeout(300)]
HERE = Path(__file__).parent
SUCCEEDED, CANCELLED, ABORTED = 4, 5, 6


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros2Session]:
    if not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    started = Ros2Session(tmp_path_factory.mktemp("actions"))
    add_messages(started.environment)
    try:
        yield started
    finally:
        started.close()


@pytest.fixture(scope="module")
def found(session: Ros2Session) -> dict[str, Any]:
    """What a client of rclpy found at a server of ours."""
    session.start("move_base", str(HERE / "goal_taker.py"))
    program = session.run(str(HERE / "nav2_client.py"), "all", within=120.0)
    assert program.stdout, program.stderr
    read: dict[str, Any] = json.loads(program.stdout.splitlines()[-1])
    return read


def test_goal_of_a_foreign_client_is_reached_with_feedback(found: dict[str, Any]) -> None:
    assert found["reached"] == [SUCCEEDED, 0, ""]
    assert found["feedback"][-1] == [3.0, 0.0]
    assert all(x + left == pytest.approx(3.0) for x, left in found["feedback"])


def test_foreign_client_reads_why_its_goal_was_refused_or_given_up(found: dict[str, Any]) -> None:
    assert found["refused"] == [ABORTED, 9000, "too far behind"]
    assert found["given up"] == [ABORTED, 9000, "there is a wall"]


def test_foreign_client_cancels_its_goal(found: dict[str, Any]) -> None:
    assert found["cancels"] == 1
    assert found["cancelled"] == [CANCELLED, 0, ""]


def test_goal_that_is_replaced_is_aborted_as_with_nav2(found: dict[str, Any]) -> None:
    assert found["replaced"] == [ABORTED, 9000, "a new goal has replaced this one"]
    assert found["replacing"] == [SUCCEEDED, 0, ""]


def test_goal_through_poses_passes_them_in_order_and_can_be_cancelled(found: dict[str, Any]) -> None:
    assert found["through"] == [SUCCEEDED, 0, ""]
    assert found["poses left"] == [3, 2, 1]
    assert found["through, cancelled"] == [CANCELLED, 0, ""]
    assert found["no poses"] == [ABORTED, 9000, "goal with 0 poses, expected 1 to 1000"]


def test_program_that_waits_for_nav2_finds_it_active(found: dict[str, Any]) -> None:
    assert found["state"] == "active"


def test_goal_of_a_client_that_was_killed_goes_on_and_another_client_cancels_it(
    session: Ros2Session, found: dict[str, Any]
) -> None:
    assert found
    command = [str(PYTHON), str(HERE / "nav2_client.py"), "leave"]
    client = subprocess.Popen(command, env=session.environment, stdout=subprocess.PIPE, text=True)
    assert client.stdout is not None
    assert client.stdout.readline() == "driving\n"
    client.kill()
    client.wait(10.0)
    client.stdout.close()
    program = session.run(str(HERE / "nav2_client.py"), "cancel", within=60.0)
    assert program.stdout, program.stderr
    other = json.loads(program.stdout.splitlines()[-1])
    assert other["before"].count(2) == 1
    assert other["cancels"] == 1
    assert other["after"].count(2) == 0


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the page and the terminal would show of goals of a server of rclpy."""
    if not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    session = Ros2Session(tmp_path_factory.mktemp("nav2"))
    session.environment["ROS_DOMAIN_ID"] = str(102 + os.getpid() % 100)
    add_messages(session.environment)
    program = session.run("-m", "ur_nodes", str(HERE / "nav2_driver.py"), within=120.0)
    assert program.stdout, program.stderr
    assert "Traceback" not in program.stderr
    read: dict[str, Any] = json.loads(program.stdout.splitlines()[-1])
    return read


def test_goals_of_ours_are_driven_to_by_nav2(shown: dict[str, Any]) -> None:
    assert shown["problem"] == ""
    assert shown["reached"] == ["reached", "", 3.0, 0]
    assert shown["driving"] == ["driving", "", 9.0, 2]
    assert shown["cancelled"][:2] == ["stopped", ""]
    assert shown["replacing"] == ["reached", "", 2.0, 0]


def test_reasons_of_nav2_are_shown(shown: dict[str, Any]) -> None:
    assert shown["given up"] == ["failed", "there is no path to the goal: tried 3 times", -3.0, 0]
    assert shown["refused"][1] == "Nav2 refused the goal; is it active? (ros2 lifecycle get /bt_navigator)"


def test_goal_of_another_client_of_nav2_is_shown_and_cancelled(shown: dict[str, Any]) -> None:
    assert shown["of another client"][:3] == ["driving", "", 9.0]
    assert shown["of another client, cancelled"][:3] == ["stopped", "", 9.0]


def test_nav2_that_dies_is_missing_and_its_goal_is_lost(shown: dict[str, Any]) -> None:
    state, text, place, _recoveries = shown["after a restart"]
    assert (state, place) == ("failed", 9.0)
    assert text == "move_base does not know the goal any more; was it restarted?"
    assert shown["reached again"] == ["reached", "", 1.0, 0]
