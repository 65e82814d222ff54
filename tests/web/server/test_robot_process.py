"""The page's node on the robot: why it has ended is found in its last lines, and shown."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
from pathlib import Path

import pytest
from tests.ros_session import RosSession
from tests.web.static.test_link_state import NODE

from ur.web.server.robot_process import RobotProcess, find_error
from ur.web.server.static_files import FOLDER

MISSING = [
    "2026-11-26 10:50:19 started",
    "error: ROS 2 Jazzy has no tf2_msgs, expected it for messages of the type tf2_msgs/TFMessage",
    "  help: sudo apt install ros-jazzy-tf2-msgs",
]


def test_error_is_found_with_its_help() -> None:
    assert find_error(MISSING) == (
        "error: ROS 2 Jazzy has no tf2_msgs, expected it for messages of the type tf2_msgs/TFMessage; "
        "help: sudo apt install ros-jazzy-tf2-msgs"
    )


def test_other_output_gives_its_last_line_without_control_characters() -> None:
    assert find_error(["Traceback (most recent call last):", "ValueError: \x1b[31mred", ""]) == "ValueError: [31mred"
    assert find_error([]) == ""
    assert len(find_error(["x" * 1000])) == 300


@pytest.mark.skipif(NODE is None, reason="Node.js is not installed")
@pytest.mark.parametrize(("problem", "shown"), [("error: x", "error: x"), ("", "Connecting to the robot ...")])
def test_page_shows_why_the_node_ends(problem: str, shown: str) -> None:
    assert NODE is not None
    facts = {"age": 0, "server": {"end": "starting", "problem": problem}, "pose": None, "poseAge": 0}
    script = (
        f"const {{ describeLink }} = await import('{FOLDER.as_uri()}/banners.js');"
        f"console.log(JSON.stringify(describeLink({json.dumps(facts)})));"
    )
    words = [NODE, "--input-type=module", "-"]
    done = subprocess.run(words, input=script, capture_output=True, text=True, timeout=120, check=True)
    ((banner,),) = (json.loads(done.stdout),)
    assert banner["text"].endswith(shown)


@pytest.mark.ros
async def test_nothing_runs_without_a_node_of_a_robot_and_the_node_of_the_page_ends_with_its_master(
    tmp_path: Path,
) -> None:
    session = RosSession(tmp_path)
    states: asyncio.Queue[str] = asyncio.Queue()
    environment = session.env | {"XDG_STATE_HOME": str(tmp_path)}

    async def next_states(count: int) -> list[str]:
        return [await asyncio.wait_for(states.get(), 60) for _ in range(count)]

    def note() -> None:
        states.put_nowait(end.state)

    end = RobotProcess(environment, lambda _: None, lambda _: None, lambda: None, note, lambda _: None)
    running = asyncio.create_task(end.run())
    try:
        assert await next_states(3) == ["starting", "up", "no master"]
        robot = session.start(sys.executable, "-c", "import rospy; rospy.init_node('robot'); rospy.spin()")
        assert await next_states(1) == ["up"]
        robot.terminate()
        assert await next_states(1) == ["no master"]
        session.start(sys.executable, "-c", "import rospy; rospy.init_node('other'); rospy.spin()")
        assert await next_states(2) == ["starting", "up"], "a node that knows nothing of the robot before"
        session.close()
        assert await next_states(2) == ["starting", "no master"]
    finally:
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        session.close()
