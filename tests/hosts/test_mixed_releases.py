"""A laptop and a robot of different releases of Debian: the set-up, the messages, and a program across the two.

The laptop of the other release has `ur` from a wheel: there is no clone that could be copied to the robot.
"""

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.hosts.bench import UR, Bench, Machine, boot
from tests.hosts.bench.root import codename
from tests.hosts.test_ready_to_run import HOST, serve_packages
from tests.hosts.test_robot_setup import PASSWORD, SUDO
from tools.build import build

from ur.robot.setup.robot_states import PROGRAM_PACKAGES

PYTHONS = {"bookworm": (3, 11), "trixie": (3, 13)}
pytestmark = [
    pytest.mark.timeout(2400),
    pytest.mark.skipif(codename() not in PYTHONS, reason="expected Debian 12 or 13 to test Debian 12 with 13"),
]
SECONDS = 1200.0
PIP = f"[global]\nindex-url = http://{HOST}/simple\ntrusted-host = {HOST}\n"
MESSAGES = """\
import importlib
for package in "actionlib geometry move_base nav rosgraph sensor std tf2 visualization".split():
    module = importlib.import_module(package + "_msgs.msg")
    for name in sorted(vars(module)):
        if hasattr(getattr(module, name), "_md5sum"):
            print(package, name, getattr(module, name)._md5sum)
for name, service in sorted(vars(importlib.import_module("std_srvs.srv")).items()):
    if hasattr(service, "_md5sum"):
        print("std_srvs", name, service._md5sum)
"""


@dataclass(frozen=True, slots=True)
class ReleasePair:
    """Two computers, of which one has another release than this one; and the command `ur` on the laptop."""

    bench: Bench
    ur: str

    @property
    def laptop(self) -> Machine:
        return self.bench["laptop"]

    @property
    def robot(self) -> Machine:
        return self.bench["robot"]


@pytest.fixture(scope="module", params=["robot", "laptop"])
def pair(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ReleasePair]:
    """A laptop with a robot that was set up from it; the one that the parameter names has the other release."""
    (suite,) = PYTHONS.keys() - {codename()}
    own = request.param == "robot"  # the laptop has this computer's release, and this repository with its environment
    with boot(("laptop", "robot"), with_repository=("laptop",) if own else (), suites={request.param: suite}) as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        serve_packages(laptop, tuple(PYTHONS.values()))
        for machine in (laptop, robot):
            machine.write("/etc/pip.conf", PIP)
        laptop.write("/etc/sudoers.d/pat", SUDO, mode=0o440)
        # What the laptop's share of a program needs, an installed `ur` sets up itself.
        install_packages(laptop, (*PROGRAM_PACKAGES, "ros-robot-state-publisher") if own else ("python3-venv",))
        if not own:
            install_wheel(laptop, build(tmp_path_factory.mktemp("dist"))[1])
        pair = ReleasePair(bench, UR if own else ".local/bin/ur")
        laptop.run(f"{pair.ur} setup --yes", user="pat", timeout=SECONDS).check()
        yield pair


def install_packages(machine: Machine, names: Collection[str]) -> None:
    install = "apt-get -qq update && apt-get -qq -y --no-install-recommends install"
    machine.run(f"{install} {' '.join(names)}", timeout=600).check()


def install_wheel(laptop: Machine, wheel: Path) -> None:
    """Install as pipx does: into an environment of its own that sees no ROS, with a link on PATH."""
    (laptop.root / "home/pat" / wheel.name).write_bytes(wheel.read_bytes())
    environment = ".local/share/pipx/venvs/ubiquity-launches"
    link = f"mkdir -p .local/bin && ln -s ~/{environment}/bin/ur .local/bin/ur"
    line = f"python3 -m venv {environment} && {environment}/bin/pip install -q ./{wheel.name} && {link}"
    laptop.run(line, user="pat", timeout=SECONDS).check()


def test_robot_of_another_release_is_set_up_and_runs_its_share(pair: ReleasePair) -> None:
    laptop, robot = pair.laptop, pair.robot
    releases = {machine.run("sed -n s/^VERSION_CODENAME=//p /etc/os-release").out for machine in (laptop, robot)}
    assert len(releases) == 2
    command = f"{pair.ur} robot setup robot.local --name bob --base magni --variant lidar --passwords-from 0 --yes"
    done = laptop.run(command, user="pat", stdin=f"ros\n{PASSWORD}\n", timeout=SECONDS).check()
    assert f"it fetches packages over this computer's connection ({HOST})" in done.out
    assert "NO" not in done.out
    assert re.search(r"ok .*programs .*ur [0-9.]+ \(copy", done.out), done.out
    version = robot.run("bash -lc 'ur --version'", user="ros").check().out
    assert version.split()[:2] == laptop.run(f"{pair.ur} --version", user="pat").check().out.split()[:2]

    begin = f"{pair.ur} run keyboard_navigate simulate:=true"
    done = laptop.run(begin, user="pat", stdin="g 1 0 0\nq\n", timeout=300)
    assert done.code == 0, f"{done.out}\n{done.err}"
    assert "g 1 0 0: reached" in done.out
    assert re.search(r"bob: \d+ nodes?, run m_keyboard_navigate", done.out + done.err), f"{done.out}\n{done.err}"
    robot.wait_for("! pgrep -u ros -f ur_nodes", deadline=60)


def test_messages_and_services_of_the_two_releases_are_the_same(pair: ReleasePair) -> None:
    sums = [machine.run(["python3", "-c", MESSAGES]).check().out.splitlines() for machine in (pair.laptop, pair.robot)]
    assert sums[0] == sums[1]
    assert len(sums[0]) >= 100
