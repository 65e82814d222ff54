"""Worlds and maps on command lines: `ur launch --dry-run` resolves and checks as a run does, and starts nothing."""

from pathlib import Path

import pytest
from tests.ros_session import free_port

from ur.cli.main import main
from ur.request.programs import PACKAGE
from ur.request.worlds import resolve_worlds
from ur.source.arguments import Argument
from ur.source.diagnostic import UserError


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a world `home`, nothing selected, no master."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("UR_SELECTION", raising=False)
    monkeypatch.setenv("ROS_MASTER_URI", f"http://localhost:{free_port()}")
    assert main(["new", "world", "home", "--size", "8x6"]) == 0
    return tmp_path


def resolve(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    capsys.readouterr()
    viewer = ["use_rviz:=false"] if NAVIGATE in words else []  # RViz need not be installed
    code = main(["launch", "--dry-run", "ubiquity_launches", *words, *viewer])
    return code, *capsys.readouterr()


def read_values(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """The parameters of all nodes, and their command lines with the variables that they get."""
    capsys.readouterr()
    assert main(["launch", "--dump-params", "ubiquity_launches", *words]) == 0
    values = capsys.readouterr().out
    return values + resolve(capsys, *words)[1]


NAVIGATE = "m_keyboard_navigate.launch.xml"


@pytest.mark.parametrize("word", ["world:=./home.yaml", "world:=home.yaml"])
def test_own_world_is_the_simulators_world_and_the_map(
    word: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, err = resolve(capsys, NAVIGATE, word)
    assert code == 0, err
    assert f"{home}/home.yaml" in out
    values = read_values(capsys, NAVIGATE, word)
    assert f"/simulator/world_file: {home}/home.yaml\n" in values
    assert f" UR_MAP_FILE={home}/home.yaml " in values


def test_map_file_may_differ_from_the_world(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    values = read_values(capsys, NAVIGATE, "world:=maze", "map_file:=home.yaml")
    assert "/n_simulator/worlds/maze.yaml\n" in values
    assert f" UR_MAP_FILE={home}/home.yaml " in values


def test_folder_with_a_blank_in_its_name_holds_worlds_too(
    home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (home / "my worlds").mkdir()
    monkeypatch.chdir(home / "my worlds")
    assert main(["new", "world", "other", "--size", "8x6"]) == 0
    assert resolve(capsys, NAVIGATE, "world:=other.yaml")[0] == 0
    (home / "my worlds" / "other.png").unlink()
    assert "other.png is missing" in resolve(capsys, NAVIGATE, "world:=other.yaml")[2]


def test_robot_starts_where_the_world_says(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with (home / "home.yaml").open("a") as file:
        file.write("start: [1.5, -1.0, 0.5]\n")
    values = read_values(capsys, NAVIGATE, "world:=home.yaml")
    for name, value in (("x", 1.5), ("y", -1.0), ("yaw", 0.5)):
        assert f"/simulator/{name}: {value}\n" in values
    assert "/amcl/initial_pose_x: 1.5\n" in values
    values = read_values(capsys, NAVIGATE, "world:=home.yaml", "x:=2.0")
    assert "/simulator/x: 2.0\n" in values
    assert "/simulator/y: 0.0\n" in values


def break_image(home: Path) -> None:
    (home / "home.png").write_bytes(b"no picture")


def remove_image(home: Path) -> None:
    (home / "home.png").unlink()


def misspell_key(home: Path) -> None:
    path = home / "home.yaml"
    path.write_text(path.read_text().replace("wall_height", "wall_hight"))


def move_origin(home: Path) -> None:
    path = home / "home.yaml"
    path.write_text(path.read_text().replace("origin: [-4.1", "origin: [-40.1"))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (break_image, "home.png is not an image"),
        (remove_image, "home.png is missing"),
        (misspell_key, "wall_hight"),
        (move_origin, "the robot starts at x = 0 m, y = 0 m, outside world 'home.yaml'"),
    ],
)
def test_world_that_cannot_be_used_is_an_error_before_anything_starts(
    change: object, said: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert callable(change)
    change(home)
    code, out, err = resolve(capsys, NAVIGATE, "world:=home.yaml")
    assert code == 1
    assert out == ""
    assert said in err


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("world:=mazee", "did you mean world:=maze?"),
        ("world:=", "world:= has no value, expected one of maze, office"),
        ("world:=hme.yaml", "did you mean 'home.yaml'?"),
        ("map_file:=hme.yaml", "did you mean 'home.yaml'?"),
        ("x:=40", "outside world"),
    ],
)
def test_wrong_world_or_map_is_an_error(word: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = resolve(capsys, NAVIGATE, *(["world:=home.yaml"] if word.startswith("x") else []), word)
    assert code in (1, 2)
    assert out == ""
    assert said in err


def test_robot_without_a_lidar_is_refused_in_a_world_without_fiducials(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = resolve(capsys, NAVIGATE, "world:=home.yaml", "robot_base:=magni")
    assert code == 1
    assert "world 'home' has no fiducials" in err
    assert resolve(capsys, NAVIGATE, "world:=home.yaml", "robot_base:=magni", "robot_variant:=lidar")[0] == 0


@pytest.mark.parametrize(
    "file",
    [
        "m_keyboard_drive", "m_joystick_teleop", "m_local_costmap", "m_robot_base", "rviz_robot", "rviz_sonar",
        "rviz_local_costmap", "m_raspicam", "m_raspicam_view",
    ],
)  # fmt: skip
def test_every_program_that_simulates_takes_an_own_world(
    file: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    values = read_values(capsys, f"{file}.launch.xml", "world:=home.yaml", "robot_base:=magni")
    assert f"/simulator/world_file: {home}/home.yaml\n" in values


def test_misspelt_argument_of_a_program_is_an_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "robot_base", "wrld:=maze"]) == 2
    err = capsys.readouterr().err
    assert "unknown argument 'wrld' of program 'robot_base', expected one of robot_base" in err
    assert "did you mean world:=...?" in err


def test_map_of_a_robot_is_a_path_on_the_robot(home: Path) -> None:
    files = [f"{PACKAGE}/m_keyboard_navigate/launch/{NAVIGATE}"]
    declared = ["robot_machine", "map_file"]
    with pytest.raises(UserError, match=r"map_file:=home.yaml is read on bob, expected the absolute path"):
        resolve_worlds([Argument("map_file", "home.yaml")], files, declared, "bob")
    there = Argument("map_file", "/maps/lab.yaml")
    assert resolve_worlds([there], files, declared, "bob") == (there,)
    here = Argument("map_file", f"{home}/home.yaml")
    assert resolve_worlds([Argument("map_file", "home.yaml")], files, declared) == (here,)


@pytest.mark.parametrize(("argument", "said"), [("world", "world file"), ("map_file", "map file")])
def test_folder_in_place_of_a_world_or_map_is_called_a_folder(
    argument: str, said: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (home / "folder").mkdir()
    code, _, err = resolve(capsys, NAVIGATE, f"{argument}:={home}/folder")
    assert code != 0
    assert err.startswith(f"error: {said} '{home}/folder' is a folder, expected the path of a ")


def test_name_of_a_map_to_be_made_is_checked_before_the_start(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = resolve(capsys, "m_make_map.launch.xml", "map:=../x", "use_rviz:=false")
    assert code != 0
    assert err.startswith("error: map name '../x', expected a letter, then letters")


def test_dry_run_leaves_out_what_the_start_leaves_out(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert main(["launch", "--dry-run", "ubiquity_launches", NAVIGATE]) == 0
    out = capsys.readouterr().out
    assert "# no display: /rviz_navigation left out\n" in out
    assert "# /rviz_navigation" not in out
