"""Processes that are killed beside a black box: its file has all messages up to then."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

import psutil
import pytest
from tests.run.leftovers import wait_nothing_left

from ur.recordings.mcap_file import open_recording
from ur.source.project import launch_library

pytestmark = pytest.mark.ros

COUNTER = """#!/usr/bin/python3
import rospy, std_msgs.msg
rospy.init_node('counter')
publisher = rospy.Publisher('numbers', std_msgs.msg.UInt64, queue_size=100)
rate, number = rospy.Rate(100), 0
while not rospy.is_shutdown():
    publisher.publish(number)
    number += 1
    rate.sleep()
"""
NODES = f"""
<node pkg="little_nodes" type="counter" name="counter" {{0}}/>
<node pkg="little_nodes" type="sleeper" name="sleeper"/>
<include file="{launch_library()}/n_black_box/launch/n_black_box.launch.xml"/>
"""
BEFORE = 0.1  # s
SECONDS = pytest.mark.parametrize("seconds", [3.0, 63.0])


class KilledRun:
    """A run with a node that counts, which the black box has recorded for some seconds."""

    def __init__(self, world: Any, seconds: float) -> None:
        counter = Path(world.folder, "little_nodes/nodes/counter")
        counter.write_text(COUNTER)
        counter.chmod(0o755)
        world.environment["ROS_PACKAGE_PATH"] += f":{launch_library()}"
        self.folder = Path(world.environment["XDG_STATE_HOME"], "ur/black_box")
        self.world = world
        self.run = world.launch(NODES.format(""))
        while not self.find("black_box_node") or not self.is_recorded():
            self.run.read()
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.run.read()

    def find(self, text: str) -> list[psutil.Process]:
        self.run.look()
        found = []
        for each in self.run.seen.values():
            try:
                if text in " ".join(each.cmdline()):
                    found.append(each)
            except psutil.Error:  # noqa: PERF203 - one that has just ended
                continue
        return found

    def is_recorded(self) -> bool:
        """Return whether the recorder has a connection to the node that counts."""
        sockets = self.folder / "sockets"
        return (
            sockets.is_dir()
            and any(sockets.iterdir())
            and any(each.status == "ESTABLISHED" for each in self.find("black_box_node")[0].net_connections("tcp"))
        )

    def kill(self, pid: int) -> float:
        """Kill a process; the time at which it happened."""
        moment = time.time()
        os.kill(pid, signal.SIGKILL)
        return moment

    def check(self, moment: float, seconds: float, reason: str) -> None:
        """Check that the recording holds the last seconds before a moment."""
        while not (found := sorted(self.folder.glob("black_box_*.mcap"))):
            self.run.read()
        recording = open_recording(found[-1])
        assert recording.complete
        assert reason in " ".join(recording.metadata["reasons"].values())
        messages = [
            (each.time / 1e9, int.from_bytes(each.data, "little"))
            for each in recording.messages(topics={"/numbers"})
            if each.time / 1e9 <= moment
        ]
        numbers = [number for _, number in messages]
        assert numbers == list(range(numbers[0], numbers[-1] + 1))
        assert messages[-1][0] > moment - BEFORE
        assert messages[-1][0] - messages[0][0] > min(60.0, seconds) - 0.5


@SECONDS
def test_node_that_was_killed_is_recorded(world: Any, seconds: float) -> None:
    killed = KilledRun(world, seconds)
    moment = killed.kill(killed.find("sleep 600")[0].pid)
    killed.check(moment, seconds, "/sleeper died: signal SIGKILL")


@SECONDS
def test_black_box_that_was_killed_is_written_by_its_guard(world: Any, seconds: float) -> None:
    killed = KilledRun(world, seconds)
    moment = killed.kill(killed.find("black_box_node")[0].pid)
    killed.check(moment, seconds, "the process of the black box was killed")


@SECONDS
def test_supervisor_that_was_killed_is_recorded_and_nothing_is_left(world: Any, seconds: float) -> None:
    killed = KilledRun(world, seconds)
    moment = killed.kill(killed.run.process.pid)
    killed.check(moment, seconds, "was killed")
    wait_nothing_left(world.folder)
