"""Two commands from a fresh robot of Debian 13 to a goal, by our own drivers and with no compiler.

The robot's devices are stand-ins at the ends of pseudo-terminals in its /dev, with a simulated robot behind them.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.hosts.bench import UR, Bench, Machine, boot
from tests.hosts.bench.root import codename
from tests.hosts.test_mixed_releases import PIP, PYTHONS, install_packages
from tests.hosts.test_ready_to_run import HOST, serve_packages
from tests.hosts.test_robot_setup import PASSWORD, SUDO

from ur.robot.setup.robot_states import PROGRAM_PACKAGES

pytestmark = [
    pytest.mark.timeout(2400),
    pytest.mark.skipif(codename() not in PYTHONS, reason="expected Debian 12 or 13, for a robot with Debian 13"),
]
SECONDS = 1200.0
HARDWARE = Path(__file__).parent / "bench" / "devices.py"
PLACE = "/run/hardware.pose"
COMPILERS = "cc gcc c++ g++ clang make cmake"


@dataclass(frozen=True, slots=True)
class RealRobot:
    """A base, and a goal with a free way."""

    base: str
    variant: str
    x: float


ROBOTS = (
    RealRobot("botvac", "botvac50", 1.0),
    RealRobot("magni", "lidar", 1.0),
)


@pytest.fixture
def pair() -> Iterator[Bench]:
    suites = {} if codename() == "trixie" else {"robot": "trixie"}
    with boot(("laptop", "robot"), suites=suites) as bench:
        laptop = bench["laptop"]
        serve_packages(laptop, tuple(PYTHONS.values()))
        for machine in (laptop, bench["robot"]):
            machine.write("/etc/pip.conf", PIP)
        laptop.write("/etc/sudoers.d/pat", SUDO, mode=0o440)
        install_packages(laptop, (*PROGRAM_PACKAGES, "ros-robot-state-publisher"))
        laptop.run(f"{UR} setup --yes", user="pat", timeout=SECONDS).check()
        yield bench


def plug_in(robot: Machine, real: RealRobot) -> None:
    """Give a robot its devices."""
    robot.write("/root/devices.py", HARDWARE.read_text())
    python = "/home/ros/ubiquity_launches/.venv/bin/python"
    robot.run(f"systemd-run --unit=hardware {python} /root/devices.py {real.base} '{real.variant}' {PLACE}").check()
    robot.wait_for(f"test -s {PLACE}", deadline=120)


@pytest.mark.parametrize("real", ROBOTS, ids=lambda real: real.base)
def test_fresh_robot_drives_to_a_goal_after_two_commands(pair: Bench, real: RealRobot) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    assert HOST in laptop.read("/etc/hosts")
    options = f"--name bob --base {real.base} --variant {real.variant} --passwords-from 0 --yes"
    done = laptop.run(
        f"{UR} robot setup robot.local {options}", user="pat", stdin=f"ros\n{PASSWORD}\n", timeout=SECONDS
    ).check()
    assert "NO" not in done.out
    # Of the set-up's packages for workspaces, nothing that compiles is left: our drivers need none of it.
    robot.run(f"cd /usr/bin && for each in {COMPILERS}; do rm -f $each $each-* *-linux-gnu-$each*; done").check()
    assert robot.run(f"command -v {COMPILERS}").out.strip() == ""
    plug_in(robot, real)
    # A map that it has made before: that of the maze, in which it is.
    latest, maps = ".local/share/ubiquity_launches/maps/latest", "ubiquity_launches/ubiquity_launches/n_map_server/maps"
    bring = f"mkdir -p {latest} && cp {maps}/maze.png {latest} && cp {maps}/maze.yaml {latest}/map.yaml"
    robot.run(bring, user="ros").check()

    ran = laptop.run(f"{UR} run keyboard_navigate", user="pat", stdin=f"g {real.x} 0 0\nq\n", timeout=400)
    assert ran.code == 0, f"{ran.out}\n{ran.err}\n{robot.run('journalctl -u hardware -n 30').out}"
    x, y = map(float, robot.run(f"cat {PLACE}").check().out.split())
    assert math.dist((x, y), (real.x, 0.0)) < 0.3, ran.out
