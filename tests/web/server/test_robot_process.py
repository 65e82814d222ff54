"""The page's node on the robot: why it has ended is found in its last lines, and shown."""

from __future__ import annotations

import asyncio
import json
import os
import socket
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from tests.ros_session import RosSession
from tests.web.static.test_link_state import NODE

from ur.run.host.protocol import FORKS, receive, send
from ur.run.join.decision import Claims, write_claims
from ur.run.record.registry import RunEntry, read_computer, register_run
from ur.source.run_users import read_birth
from ur.system.child_processes import start_node
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


FORKED = "import sys; sys.stderr.write('error: forked\\n'); sys.stdin.buffer.read()"


async def test_node_is_forked_by_a_run_of_the_same_master_and_executed_by_others(tmp_path: Path) -> None:
    environment = os.environ | {"XDG_STATE_HOME": str(tmp_path), "ROS_MASTER_URI": "http://localhost:1"}
    environment |= {"XDG_RUNTIME_DIR": str(tmp_path), "ROS_VERSION": "1"}
    computer, printed, modules = read_computer(), asyncio.Queue[str](), list[str]()
    facts = RunEntry(
        "a-run", os.getpid(), read_birth(os.getpid()) or 0, "t", "http://localhost:1/", "", 0.0, False, "h"
    )
    registered = register_run(replace(facts, machine=computer.machine, boot=computer.boot), environment, os.getuid())
    assert registered is not None
    entry, listener = registered
    end = RobotProcess(environment, lambda _: None, lambda _: None, lambda: None, lambda: None, lambda _: None)

    def fork() -> subprocess.Popen[bytes]:
        with server, server.accept()[0] as client:
            (_, (module, *_), *_), files = receive(client)
            modules.append(module)
            process = subprocess.Popen([sys.executable, "-c", FORKED], stdin=files[0], stdout=files[1], stderr=files[2])
            for each in files:
                os.close(each)
            gate, opener = os.pipe()
            send(client, ("", process.pid), (opener,))
            os.close(opener)
            with os.fdopen(gate, "rb") as opened:
                assert opened.read() == b"1"
        return process

    write_claims(entry.folder, Claims(base=("/base",)))
    with listener, socket.socket(socket.AF_UNIX) as server:
        server.settimeout(60.0)
        server.bind(f"{entry.folder}/{FORKS}")
        server.listen()
        forking = asyncio.create_task(asyncio.to_thread(fork))
        node = await start_node("parrot", environment, printed.put_nowait, end._fork_or_start, links=2)
        process = await forking
        assert (node.process.pid, modules) == (process.pid, ["parrot"])
        reaping = asyncio.create_task(asyncio.to_thread(process.wait, 60))
        assert await asyncio.wait_for(printed.get(), 60) == "error: forked"
        await node.close()
        assert (printed.empty(), node.process.returncode, await reaping) == (True, 0, 0)
        server.close()
        other = await start_node("no_such_module", environment, printed.put_nowait, end._fork_or_start, links=2)
        await other.close()
        assert isinstance(other.process, asyncio.subprocess.Process)


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
        session.stop(session.running[0])  # the master: without the node, nothing would run while it still answers
        assert await next_states(2) == ["starting", "no master"]
    finally:
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        session.close()
