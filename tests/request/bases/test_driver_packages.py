from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.world.system import SystemWorld
from ur.request.bases.base_argument import check_drivers, describe_base_of, find_bases
from ur.request.launch_request import LaunchFiles
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.source.diagnostic import Diagnostic, UserError

LIBRARY = Path(__file__).parents[3] / "ubiquity_launches"
FILE = str(LIBRARY / "m_robot_base" / "launch" / "m_robot_base.launch.xml")


def make_world(*packages: Path) -> SystemWorld:
    return SystemWorld({"ROS_PACKAGE_PATH": ":".join(map(str, (LIBRARY, *packages)))})


def find_problems(world: SystemWorld, **values: str) -> tuple[Diagnostic, ...]:
    plan = load_plan([FILE], [f"{name}:={value}" for name, value in values.items() if value], world)
    assert plan.diagnostics == ()
    try:
        check_drivers(find_bases(LaunchFiles([FILE], world), values), plan.nodes, world)
    except UserError as problem:
        return problem.diagnostics
    return ()


@pytest.mark.parametrize(
    ("base", "variant", "packages"),
    [
        ("stage", "", ["stage_ros"]),
    ],
)
def test_each_missing_driver_is_named_with_why_and_how_to_get_it(base: str, variant: str, packages: list[str]) -> None:
    found = find_problems(make_world(), robot_base=base, robot_variant=variant, simulate="false")
    assert [each.message.split("'")[1] for each in found] == packages
    for each in found:
        assert f"of a real {base}" in each.message or f"drives a real {base}" in each.message
        assert each.help is not None
        assert each.help.startswith("clone https://github.com/")
        assert each.span is not None


@pytest.mark.parametrize(
    ("base", "variant"), [("botvac", ""), ("botvac", "xv11"), ("loki", ""), ("magni", ""), ("magni", "lidar")]
)
def test_base_with_drivers_of_this_project_needs_no_package_of_others(base: str, variant: str) -> None:
    assert not find_problems(make_world(), robot_base=base, robot_variant=variant, simulate="false")


def test_driver_that_is_installed_is_not_mentioned(tmp_path: Path) -> None:
    (tmp_path / "stage_ros").mkdir()
    (tmp_path / "stage_ros" / "package.xml").write_text("<package><name>stage_ros</name></package>")
    assert not find_problems(make_world(tmp_path), robot_base="stage", simulate="false")


def test_simulated_base_needs_no_driver() -> None:
    assert not find_problems(make_world(), robot_base="magni")


@pytest.mark.parametrize("board", sorted(name for name, driver in OWN_DRIVERS.items() if not driver.sensor))
def test_explanation_of_a_driver_and_the_page_of_drivers_name_a_board_without_a_watchdog(board: str) -> None:
    driver = LIBRARY / "n_base_driver" / "launch" / "n_base_driver.launch.xml"
    plan = load_plan([str(driver)], ["robot_base:=magni", f"board:={board}"], make_world())
    drives_on = OWN_DRIVERS[board].drives_on
    assert ("no watchdog" in describe_base_of(plan.nodes[0], plan)) is drives_on
    page = (LIBRARY.parent / "docs" / "how-to" / "drivers.md").read_text()
    [row] = [line for line in page.splitlines() if line.startswith(f"| `{board}` | ")]
    assert row.endswith("| **never** |") is drives_on
    assert drives_on or row.endswith(f"| {OWN_DRIVERS[board].watchdog:g} s |")
