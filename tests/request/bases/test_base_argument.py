import shutil
from pathlib import Path

import pytest

from ur.launchfile.world.system import SystemWorld
from ur.request.bases.base_argument import check_bases, find_bases
from ur.request.launch_request import LaunchFiles
from ur.robot.base import Base, load_base
from ur.source.diagnostic import UserError

LIBRARY = Path(__file__).parents[3] / "ubiquity_launches"


@pytest.fixture
def launch_file(tmp_path: Path) -> Path:
    """A launch file that needs a lidar, in a package with the bases of the library."""
    package = tmp_path / "robots"
    shutil.copytree(LIBRARY / "bases", package / "bases")
    (package / "package.xml").write_text("<package><name>robots</name></package>", encoding="utf-8")
    path = package / "m_go" / "launch" / "m_go.launch.xml"
    path.parent.mkdir(parents=True)
    path.write_text("<launch><!--Needs: lidar--><arg name='robot_base'/></launch>", encoding="utf-8")
    return path


def check_base(path: Path, values: dict[str, str]) -> None:
    files = LaunchFiles([str(path)], SystemWorld({}))
    check_bases(files, find_bases(files, values))


def find_problem(path: Path, **values: str) -> UserError:
    with pytest.raises(UserError) as caught:
        check_base(path, values)
    return caught.value


def test_base_that_has_what_is_needed_is_accepted(launch_file: Path) -> None:
    check_base(launch_file, {"robot_base": "stage"})
    check_base(launch_file, {"robot_base": "magni", "robot_variant": "lidar"})


def test_base_without_the_sensor_is_refused_and_the_variant_with_it_named(launch_file: Path) -> None:
    (finding,) = find_problem(launch_file, robot_base="magni").diagnostics
    assert finding.message == "m_go.launch.xml needs a lidar, and base 'magni' has none"
    assert finding.help == "its variant 'lidar' has what is needed: robot_variant:=lidar"


def test_bases_that_have_the_sensor_are_named_where_no_variant_has_it(launch_file: Path) -> None:
    launch_file.write_text(launch_file.read_text().replace("lidar", "sonars"))
    (finding,) = find_problem(launch_file, robot_base="stage").diagnostics
    assert finding.message == "m_go.launch.xml needs sonars, and base 'stage' has none"
    assert finding.help == "choose another base: robot_base:=loki, or magni"


def test_unknown_base_is_refused(launch_file: Path) -> None:
    assert "unknown base 'magnni'" in str(find_problem(launch_file, robot_base="magnni"))


def test_package_without_bases_is_left_alone(launch_file: Path) -> None:
    shutil.rmtree(launch_file.parents[2] / "bases")
    assert find_bases(LaunchFiles([str(launch_file)], SystemWorld({})), {"robot_base": "anything"}) == ()


def test_base_of_several_files_of_a_package_is_loaded_once(launch_file: Path) -> None:
    loaded: list[str] = []

    def load(package: Path, name: str, variant: str) -> Base:
        loaded.append(name)
        return load_base(package, name, variant)

    files = LaunchFiles([str(launch_file), str(launch_file)], SystemWorld({}))
    first, second = find_bases(files, {"robot_base": "magni"}, load)
    assert first.base is second.base
    assert loaded == ["magni"]
