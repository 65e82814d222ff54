"""`ur mount`: files of the robot here, and what a network that drops does to programs that look at them."""

import sys
import time

import pytest
from tests.hosts.bench import UR, Bench
from tests.hosts.test_doctor import pair
from tests.hosts.test_robot_setup import PASSWORD

__all__ = ["pair"]
CUT_SECONDS = 30.0
FROZEN = 60.0  # nothing came back while the network was cut, which lasts until something does


def test_mount_survives_a_cut_without_freezing_and_is_taken_away(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.run(f"{UR} mount bob", user="pat").check()
    robot.run("echo there >catkin_ws/src/file", user="ros").check()
    assert laptop.run("cat robots/bob/file", user="pat").check().out == "there\n"
    assert "already" in laptop.run(f"{UR} mount bob", user="pat").check().out

    robot.cut()
    begin = time.monotonic()
    took: list[float] = []
    while time.monotonic() < begin + CUT_SECONDS or len(took) < 3:
        start = time.monotonic()
        laptop.run("ls robots/bob", user="pat", timeout=FROZEN)  # any answer will do, but one must come
        took.append(time.monotonic() - start)
    robot.restore()
    sys.stdout.write(f"cut for {CUT_SECONDS:g} s: {len(took)} times ls, the longest took {max(took):.1f} s\n")
    laptop.wait_for("cat robots/bob/file", user="pat", deadline=60)
    laptop.run("echo back >robots/bob/answer", user="pat").check()
    assert robot.run("cat catkin_ws/src/answer", user="ros").out == "back\n"

    robot.cut()
    assert "unmounted" in laptop.run(f"{UR} mount --undo bob", user="pat").check().out
    robot.restore()
    assert "sshfs" not in laptop.run("cat /proc/self/mounts").out
    assert PASSWORD not in laptop.journal()
    laptop.wait_for("ping -c 1 -W 1 bob.local", deadline=60)


def test_mount_over_the_workspace_hides_it_until_it_is_taken_away(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.run("echo mine >catkin_ws/src/mine", user="pat").check()
    robot.run("echo theirs >catkin_ws/src/theirs", user="ros").check()
    laptop.run(f"{UR} mount bob --over", user="pat").check()
    assert laptop.run("ls catkin_ws/src", user="pat").out.split().count("theirs") == 1
    assert "mine" not in laptop.run("ls catkin_ws/src", user="pat").out.split()
    laptop.run("echo new >catkin_ws/src/new", user="pat").check()
    assert "unmounted" in laptop.run(f"{UR} mount --undo bob", user="pat").check().out
    assert laptop.run("cat catkin_ws/src/mine", user="pat").out == "mine\n"
    assert robot.run("cat catkin_ws/src/new", user="ros").out == "new\n"


def test_mount_whose_sshfs_was_killed_is_mounted_again(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    robot.run("echo there >catkin_ws/src/file", user="ros").check()
    laptop.run(f"{UR} mount bob", user="pat").check()
    laptop.run("pkill -KILL -u pat -x sshfs").check()
    laptop.wait_for("! cat robots/bob/file", user="pat", deadline=60)
    again = laptop.run(f"{UR} mount bob", user="pat").check()
    assert "already" not in again.out
    assert laptop.run("cat robots/bob/file", user="pat").check().out == "there\n"
    assert "unmounted" in laptop.run(f"{UR} mount --undo bob", user="pat").check().out


def test_mount_on_a_folder_with_files_is_refused(pair: Bench) -> None:
    done = pair["laptop"].run(f"{UR} mount bob --at /etc", user="pat")
    assert done.code == 2
    assert "not empty" in done.err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("nobody", "no computer answers to this name"),
        ("bob --folder nowhere", "nowhere is not there"),
        ("bob --at here --over", "two places"),
        ("", "no robot given"),
    ],
)
def test_mount_that_cannot_be_is_explained_and_leaves_nothing(pair: Bench, words: str, said: str) -> None:
    laptop = pair["laptop"]
    laptop.run(f"{UR} use sim", user="pat").check()  # the set-up has selected the robot
    done = laptop.run(f"{UR} mount {words}", user="pat")
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err
    assert laptop.run("ls -d robots/nobody here 2>/dev/null", user="pat").out == ""
    assert "sshfs" not in laptop.run("cat /proc/self/mounts").out
