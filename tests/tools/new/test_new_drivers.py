"""A new base whose drivers are part of this project."""

from pathlib import Path

import pytest

from ur.cli.main import main
from ur.launchfile.load import load_plan
from ur.launchfile.world.system import SystemWorld
from ur.robot.base import load_base
from ur.source.project import launch_library

LIBRARY = launch_library()
FIGURES = [
    *("--length", "0.3", "--width", "0.3", "--height", "0.2", "--mass", "4"),
    *("--wheel-radius", "0.036", "--wheel-separation", "0.235"),
]
WORDS = ["--summary", "It drives.", *FIGURES, "--velocity", "0.3", "--angular-velocity", "1"]


@pytest.fixture(autouse=True)
def _own_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


def test_new_base_starts_its_drivers_and_their_stand_ins(tmp_path: Path) -> None:
    drivers = ["--lidar", "--driver", "arduino", "--lidar-driver", "rplidar"]
    assert main(["new", "base", "robby", "--workspace", str(tmp_path / "own"), *WORDS, *drivers]) == 0
    base = load_base(tmp_path / "own" / "share" / "ubiquity_launches", "robby")
    assert base.driver
    assert [base.driver.protocol, *(each.protocol for each in base.drivers)] == ["arduino", "rplidar"]
    world = SystemWorld({"ROS_PACKAGE_PATH": str(LIBRARY), "CMAKE_PREFIX_PATH": str(tmp_path / "own")})
    file = str(LIBRARY / "m_robot_base" / "launch" / "m_robot_base.launch.xml")
    plan = load_plan([file], ["robot_base:=robby", "simulate:=devices"], world)
    assert plan.diagnostics == ()
    assert {"simulator", "base_driver", "lidar_driver"} <= {node.name for node in plan.nodes}
    values = {param.name: param.value for param in plan.params}
    assert load_base(str(values["/base_driver/package"]), "robby") == base
    assert values["/base_driver/device_folder"] == values["/simulator/devices"]


@pytest.mark.parametrize(("given", "speeds"), [([], (0.22, 1.82)), (["--velocity", "0.2"], (0.2, 1.82))])
def test_speeds_of_a_turtlebot3_are_those_of_its_makers_unless_given(
    tmp_path: Path, given: list[str], speeds: tuple[float, float]
) -> None:
    own = str(tmp_path / "own")
    words = ["new", "base", "burger", "--workspace", own, "--summary", "It drives.", *FIGURES]
    assert main([*words, "--driver", "turtlebot3", *given]) == 0
    limits = load_base(tmp_path / "own" / "share" / "ubiquity_launches", "burger").limits
    assert (limits.velocity, limits.angular_velocity) == speeds


@pytest.mark.parametrize(
    ("option", "name", "help_"),
    [
        ("--driver", "ardiuno", "did you mean arduino?"),
        ("--lidar-driver", "magni", "add `driver` to base.yaml by hand"),
    ],
)
def test_driver_that_is_not_known_is_refused_before_anything_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str, name: str, help_: str
) -> None:
    words = ["new", "base", "robby", "--workspace", str(tmp_path / "own"), *WORDS, option, name]
    assert main(words) == 2
    reported = capsys.readouterr().err
    assert f"unknown driver '{name}' for {option}, expected one of" in reported
    assert help_ in reported
    assert not (tmp_path / "own").exists()
