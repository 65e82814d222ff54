"""Two commands from a laptop without any ROS to a robot with ROS 2: its keys drive, a cut stops it."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.hosts.bench import REPOSITORY, UR, Bench, Machine, boot, wait_until
from tests.hosts.bench.ros2_robot import install_ros2, remove_ros1
from tests.hosts.test_ros2_robot import SUDO, set_up
from tests.terminal import TmuxTerminal

AT_REST = 0.3  # s
KEY_PAUSE = 0.03  # s, as a keyboard repeats


@contextmanager
def set_up_pair(distro: str, *arguments: str) -> Iterator[Bench]:
    """A robot with a release of ROS 2, set up from a laptop. Both have this project as a clone of the user's."""
    with boot(("laptop", "robot"), with_repository=("laptop", "robot")) as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        remove_ros1(laptop)
        install_ros2(robot, distro, *arguments)
        for name, user in (("laptop", "pat"), ("robot", "ros")):
            bench[name].write(f"/etc/sudoers.d/{user}", SUDO.format(user=user), mode=0o440)
        robot.run(f"ln -s {REPOSITORY} ubiquity_launches", user="ros").check()
        set_up(laptop).check()
        laptop.run(f"{UR} use robot", user="pat").check()
        yield bench


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    with set_up_pair("jazzy") as bench:
        yield bench


@contextmanager
def program(laptop: Machine, line: str, folder: Path) -> Iterator[TmuxTerminal]:
    """A program on a terminal of the laptop."""
    terminal = TmuxTerminal(laptop.command_line(f"TERM=xterm exec {UR} {line}", user="pat"), folder)
    try:
        yield terminal
    finally:
        terminal.close()


@contextmanager
def key_held(terminal: TmuxTerminal, key: str) -> Iterator[None]:
    """A key that repeats."""
    released = threading.Event()

    def repeat() -> None:
        while not released.wait(KEY_PAUSE):
            terminal.type(key)

    thread = threading.Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        released.set()
        thread.join()


def commands(robot: Machine) -> list[tuple[float, float, float]]:
    """The commands that the base has received: time (s of the steady clock that all share), m/s, rad/s."""
    rows = (line.split() for line in robot.run("cat /run/base/log").out.splitlines())
    return [(float(row[0]), float(row[1]), float(row[2])) for row in rows if len(row) == 3]


def last_motion(robot: Machine) -> float:
    """The time of the last command that moves the base; 0.0 before the first."""
    return max((at for at, ahead, turn in commands(robot) if ahead or turn), default=0.0)


@pytest.mark.timeout(900)
def test_keys_of_the_laptop_drive_and_a_cut_of_the_network_stops_the_base(pair: Bench, tmp_path: Path) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    with program(laptop, "run keyboard_drive obstacle_stop:=false", tmp_path) as terminal:
        terminal.until("hold a key", 120.0)
        with key_held(terminal, "i"):
            begin = time.monotonic()
            wait_until(lambda: last_motion(robot) > begin, "the base moves", 20.0)
            laptop.cut()
            cut = time.monotonic()
            try:
                wait_until(lambda: time.monotonic() > cut + 2.0, "the cut lasts", 5.0)
                stopped = last_motion(robot)
            finally:
                laptop.restore()
        assert stopped - cut <= AT_REST
        assert commands(robot)[-1][1:] == (0.0, 0.0)
        restored = time.monotonic()
        wait_until(lambda: time.monotonic() > restored + 3.0, "held back keys have arrived", 5.0)
        assert last_motion(robot) == stopped  # what the cut has held back drives nothing
        with key_held(terminal, "i"):
            wait_until(lambda: last_motion(robot) > restored, "the base moves again", 20.0)
