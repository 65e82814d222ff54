"""`ur mount`: files of the robot here, and what a network that drops does to programs that look at them."""

from __future__ import annotations

import time

import pytest
from tests.hosts.bench import UR, Bench
from tests.hosts.test_doctor import pair
from tests.hosts.test_robot_setup import PASSWORD

pytestmark = pytest.mark.long
__all__ = ["pair"]
CUT_SECONDS = 30.0


def test_mount_survives_a_cut_without_freezing_and_is_taken_away(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.run(f"{UR} mount bob", user="pat").check()
    robot.run("echo there >catkin_ws/src/file", user="ros").check()
    assert laptop.run("cat robots/bob/file", user="pat").check().out == "there\n"
    assert "already" in laptop.run(f"{UR} mount bob", user="pat").check().out

    robot.cut()
    end = time.monotonic() + CUT_SECONDS
    while time.monotonic() < end:
        laptop.run("ls robots/bob", user="pat", timeout=15)  # any answer will do, but one must come
    robot.restore()
    laptop.wait_for("cat robots/bob/file", user="pat")
    laptop.run("echo back >robots/bob/answer", user="pat").check()
    assert robot.run("cat catkin_ws/src/answer", user="ros").out == "back\n"

    robot.cut()
    assert "unmounted" in laptop.run(f"{UR} unmount bob", user="pat").check().out
    robot.restore()
    assert "sshfs" not in laptop.run("cat /proc/self/mounts").out
    assert PASSWORD not in laptop.journal()


def test_mount_on_a_folder_with_files_is_refused(pair: Bench) -> None:
    done = pair["laptop"].run(f"{UR} mount bob --at /etc", user="pat")
    assert done.code == 2
    assert "not empty" in done.err
