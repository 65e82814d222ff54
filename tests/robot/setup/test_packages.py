"""A set-up installs all that programs need; and the computers of the test bench have it, or offer it."""

import re
from pathlib import Path

import pytest

from ur.robot.setup import robot_states as there
from ur.robot.setup import viewer_states as here
from ur.system.releases import load_ros_packages

BENCH = Path(__file__).parents[2] / "hosts" / "bench"
SET_UP = Path(__file__).parents[3] / "tools" / "set_up.bash"


@pytest.mark.parametrize(
    "wanted", [here.PACKAGES, there.PACKAGES, there.PROGRAM_PACKAGES], ids=["viewer", "robot", "programs"]
)
def test_bench_has_or_offers_all_that_a_setup_installs(wanted: tuple[str, ...]) -> None:
    known = {line for name in ("packages.txt", "offered.txt") for line in (BENCH / name).read_text().splitlines()}
    assert [entry for entry in wanted if known.isdisjoint(entry.split("|"))] == []


def test_robot_gets_all_packages_of_the_projects_own_set_up() -> None:
    found = re.search(r"(?m)^packages=\((\w.*) \"\$\{packages\[@\]\}\"\)$", SET_UP.read_text())
    assert found
    wanted = {*found[1].split(), *load_ros_packages()}
    assert wanted - {*there.PACKAGES, *there.PROGRAM_PACKAGES} == set()
    assert set(there.PROGRAM_PACKAGES) <= wanted
