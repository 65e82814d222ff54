from pathlib import Path

import pytest

from ur.launchfile.world.system import SystemWorld
from ur.request.bases.base_argument import find_bases
from ur.request.bases.localisation import choose_localisation, explain_no_map
from ur.request.launch_request import LaunchFiles, make_request
from ur.request.plan_files import localisation_argument
from ur.source.arguments import Argument, CommandLine, split_argv
from ur.source.diagnostic import UserError, error

LIBRARY = Path(__file__).parents[3] / "ubiquity_launches"
FILE = str(LIBRARY / "m_keyboard_navigate" / "launch" / "m_keyboard_navigate.launch.xml")


def choose(values: dict[str, str], path: str = FILE) -> list[Argument]:
    files = LaunchFiles([path], SystemWorld({}))
    return choose_localisation(values, lambda: find_bases(files, values))


def test_base_with_a_camera_alone_is_localised_by_fiducials() -> None:
    assert choose({"robot_base": "magni"}) == [Argument("localisation", "fiducials")]


@pytest.mark.parametrize(
    "values",
    [
        {"robot_base": "stage"},
        {"robot_base": "magni", "robot_variant": "lidar"},
        {"robot_base": "magni", "localisation": "amcl"},
        {},
    ],
)
def test_lidar_or_what_is_given_decides(values: dict[str, str]) -> None:
    assert choose(values) == []


def test_nothing_is_added_for_a_file_of_a_package_without_bases() -> None:
    assert choose({"robot_base": "magni"}, "/tmp/x.launch") == []


def test_nothing_is_added_where_it_is_not_declared(tmp_path: Path) -> None:
    path = tmp_path / "a.launch"
    path.write_text('<launch><arg name="robot_base"/></launch>')
    _, arguments = split_argv(["robot_base:=magni"])
    assert localisation_argument(make_request(CommandLine((str(path),)), SystemWorld({})), arguments) == []


def test_unknown_method_is_refused() -> None:
    with pytest.raises(UserError, match="localisation:=fiducial, expected one of amcl, fiducials") as caught:
        choose({"robot_base": "magni", "localisation": "fiducial"})
    assert caught.value.diagnostics[0].help == "did you mean 'fiducials'?"


def test_robot_without_lidar_and_map_of_fiducials_is_told_how_to_drive() -> None:
    problem = UserError(error("map.txt is not there", rule="no-file"))
    values = {"robot_base": "mule", "localisation": "fiducials"}
    [found] = explain_no_map(problem, values).diagnostics
    assert found.message == "base 'mule' has no lidar, and there is no map of fiducials for its camera"
    assert "ur run keyboard_drive robot_base:=mule; or" in (found.help or "")
    assert explain_no_map(problem, {**values, "localisation": "amcl"}) is problem
