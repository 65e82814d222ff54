"""`ur new` as it is typed: what it writes passes the check, and is laid out as `ur format` does."""

from __future__ import annotations

import io
import os
import re
from pathlib import Path

import click
import pytest
import yaml
from tests.robot.description.urdfs import MESHES, SMALL

from ur.cli.files.new_things import describe_observed
from ur.cli.main import main
from ur.cli.verbs import load_verb
from ur.request.programs import PACKAGE as LIBRARY
from ur.robot.base import load_base, read_base
from ur.robot.base.files import find_base_package
from ur.tools.new.parts import NodeTopic, Observed
from ur.tools.new.target import find_target

PACKAGE = ["new", "package", "my_robot", "--summary", "Mine.", "--maintainer", "A & B", "--email", "a@b.invalid"]


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", "")
    monkeypatch.chdir(tmp_path)
    assert main(PACKAGE) == 0
    monkeypatch.chdir(tmp_path / "my_robot")
    return tmp_path / "my_robot"


def test_new_alone_lists_what_can_be_made_with_an_example_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new"]) == 2
    out, told = capsys.readouterr()
    assert out == ""
    assert told.startswith("error: 'ur new' needs to know what to write, expected one of:\n")
    group = load_verb("new")
    assert isinstance(group, click.Group)
    for name, kind in group.commands.items():
        summary = (kind.help or "").split("\n")[0].removesuffix(".")
        assert f"\n  {name}: {summary}" in told
        (example,) = [line.split() for line in told.splitlines() if line.startswith(f"    ur new {name} ")]
        kind.make_context(name, example[3:], resilient_parsing=True)  # every option exists


@pytest.mark.parametrize(
    ("observed", "text"),
    [
        (Observed((NodeTopic("a", "b/C", True),), ("s",), {"p": 1}), "seen: 1 topic, 1 service, 1 parameter"),
        (Observed((), (), {"p": 1, "q": 2}), "seen: 0 topics, 0 services, 2 parameters"),
    ],
)
def test_one_parameter_is_not_called_several(observed: Observed, text: str) -> None:
    assert describe_observed(observed) == text


def finds_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    # RViz need not be installed here.
    check = ["check", "--strict", "--ignore", "unknown-package", "--ignore", "package-not-installed", "."]
    assert main(check) == 0, capsys.readouterr().out
    assert main(["format", "--check", "."]) == 0


def test_package_with_group_and_program_passes_the_check(package: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        main(["new", "multi", "drive", "--summary", "Drive.", "--include", "m_robot_base", "--include", "n_joy"]) == 0
    )
    assert (package / "bin" / "ur_drive").stat().st_mode & 0o111
    assert "A &amp; B" in (package / "package.xml").read_text()
    finds_nothing(capsys)


def test_node_that_is_not_looked_at_passes_the_check(package: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--from-package", "ubiquity_launches", "--type", "joy_node", "--summary", "Read a joystick.", "--no-look"]
    assert main(["new", "node", "stick", *words]) == 0
    assert main(["new", "multi", "part", "--summary", "A part.", "--include", "n_stick", "--no-program"]) == 0
    assert main(["new", "multi", "drive", "--summary", "Drive.", "--include", "m_part", "--program"]) == 0
    assert [path.name for path in (package / "bin").glob("ur_*")] == ["ur_drive"]
    assert (package / "n_stick" / "launch" / "n_stick.launch.xml").is_file()
    finds_nothing(capsys)


@pytest.mark.usefixtures("package")
def test_base_is_there_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "base", "dot", "--summary", "A dot.", "--length", "0.2", "--width", "0.2", "--lidar"]) == 0
    assert "wrote bases/dot/base.yaml" in capsys.readouterr().out
    finds_nothing(capsys)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["multi", "x", "--summary", "s", "--include", "n_joi"], "did you mean n_joy?"),
        (
            ["node", "x", "--from-package", "ubiquity_launches", "--type", "joy_nod", "--summary", "s"],
            "did you mean joy_node?",
        ),
        (["node", "x", "--from-package", "ubiquity_launch", "--type", "joy"], "--summary is required"),
        (["multi", "Bad-Name", "--summary", "s"], "expected lower-case letters, digits and _"),
        (["base", "x", "--summary", "s", "--mass", "-1"], "invalid --mass '-1', expected a number from 0.01 to 100000"),
        (["base", "x", "--summary", "s", "--mass", "nan"], "invalid --mass 'nan'"),
        (["base", "x", "--summary", "s", "--velocity", "inf"], "invalid --velocity 'inf'"),
        (
            ["base", "x", "--summary", "s", "--wheel-radius", "0"],
            "invalid --wheel-radius '0', expected a number from 0.005",
        ),
        (["base", "x", "--summary", "s", "--like", "nothing"], "package 'my_robot' has no bases yet"),
        (["multi", "x", "--summary", "s", "--package", "nowhere"], "no folder or package named 'nowhere'"),
    ],
)
def test_wrong_words_are_explained_and_nothing_is_written(
    words: list[str], told: str, package: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(package.rglob("*"))
    assert main(["new", *words]) == 2
    assert told in capsys.readouterr().err
    assert sorted(package.rglob("*")) == before


def test_base_like_a_missing_one_lists_the_bases_and_the_nearest(
    package: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", "base", "rover", "--summary", "s"]) == 0
    assert main(["new", "base", "x", "--summary", "s", "--like", "rovr"]) == 2
    told = capsys.readouterr().err
    assert "unknown base 'rovr' for --like, expected one of rover" in told
    assert "help: did you mean rover?" in told
    assert not (package / "bases" / "x").exists()


def test_second_base_of_a_package_needs_no_base_called_stage(package: Path) -> None:
    assert main(["new", "base", "one", "--summary", "s"]) == 0
    assert main(["new", "base", "two", "--summary", "s"]) == 0
    assert (package / "bases" / "two" / "base.yaml").is_file()


@pytest.mark.parametrize("end", [1, 2], ids=["least", "most"])
@pytest.mark.usefixtures("package")
def test_figures_at_the_ends_of_their_ranges_make_a_base(end: int, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["length", "width", "height", "mass", "wheel-radius", "wheel-separation", "velocity", "angular-velocity"]
    options.append("lateral-velocity")
    figures: list[str] = []
    for option in options:
        assert main(["new", "base", "x", "--summary", "s", f"--{option}", "-1"]) == 2
        told = re.search(r"expected a number from (\S+) to (\S+)", capsys.readouterr().err)
        assert told is not None
        figures += [f"--{option}", told[end]]
    assert main(["new", "base", "x", "--summary", "s", *figures, "--lidar", "--raspicam"]) == 0


def test_base_with_mecanum_wheels_drives_sideways_and_has_no_driver_for_two_wheels(
    package: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["new", "base", "x", "--summary", "s", "--lateral-velocity", "0.3"]
    assert main([*words, "--driver", "create2"]) == 2
    assert "--driver create2 drives two wheels, expected no --lateral-velocity" in capsys.readouterr().err
    assert main(words) == 0
    assert read_base(package / "bases" / "x" / "base.yaml", "x").limits.lateral_velocity == 0.3


def test_nothing_is_written_twice(package: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["new", "multi", "drive", "--summary", "Drive.", "--include", "n_joy"]
    assert main(words) == 0
    text = (package / "m_drive" / "launch" / "m_drive.launch.xml").read_text()
    assert main(words) == 2
    assert "is there already" in capsys.readouterr().err
    assert (package / "m_drive" / "launch" / "m_drive.launch.xml").read_text() == text


def test_the_launch_library_is_a_package_that_is_found_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    target = find_target("ubiquity_launches")
    assert (target.name, target.folder) == ("ubiquity_launches", LIBRARY)


@pytest.mark.parametrize("summary", ["Two: wheels.", "A # sign.", "- 'It' said \"hm\" {", "Größe \\ 1", "12"])
def test_summary_of_a_base_may_hold_any_character(summary: str, package: Path) -> None:
    assert main(["new", "base", "x", "--summary", summary]) == 0
    assert read_base(package / "bases" / "x" / "base.yaml", "x").summary == summary


@pytest.fixture
def small(tmp_path: Path) -> Path:
    path = tmp_path / "small.urdf"
    path.write_text(SMALL, encoding="utf-8")
    return path


def test_base_from_a_description_is_written_with_its_sources(
    package: Path, small: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    speeds = ["--velocity", "0.22", "--angular-velocity", "1.5"]
    assert main(["new", "base", "small", "--from", str(small), *speeds]) == 0
    out, told = capsys.readouterr()
    assert "wrote bases/small/base.yaml" in out
    assert "read: mass 0.965 (sum of all links)" in told
    assert "read: lidar base_scan (gazebo sensor on base_scan)" in told
    assert "mass: 0.965 # sum of all links" in (package / "bases" / "small" / "base.yaml").read_text()
    finds_nothing(capsys)


def test_limits_of_a_controller_are_those_of_the_base_and_slower_ones_of_nav2_those_of_navigation(
    package: Path, small: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nav2 = "velocity_smoother: {ros__parameters: {max_velocity: [0.26, 0.0, 1.0]}}"
    small.with_name("small.yaml").write_text(nav2, encoding="utf-8")
    control = "diffdrive_controller: {linear.x.max_velocity: 0.46, angular.z.max_velocity: 1.4}"
    small.with_name("control.yaml").write_text(control, encoding="utf-8")
    (small.parent / ".git").mkdir()
    assert main(["new", "base", "small", "--from", str(small)]) == 0
    assert "read: navigation velocity 0.26 (velocity_smoother of small.yaml)" in capsys.readouterr().err
    limits = read_base(package / "bases" / "small" / "base.yaml", "small").limits
    assert (limits.velocity, limits.angular_velocity) == (0.46, 1.4)


def test_everything_that_a_description_lacks_is_named_at_once(
    package: Path, small: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small.write_text(
        SMALL.replace('<mass value="0.8"/>', '<mass value="0"/>').replace("0.005", "0").replace('"0.1"', '"0"')
    )
    assert main(["new", "base", "small", "--from", str(small)]) == 2
    told = capsys.readouterr().err
    assert f"error: cannot read from '{small}': mass" in told
    assert "help: add, with your robot's figures: --mass 6" in told
    assert not (package / "bases").exists()


class TypedAnswers(io.StringIO):
    """A terminal on which somebody has typed."""

    def isatty(self) -> bool:
        return True


def test_terminal_is_asked_once_for_each_figure_that_is_not_read(
    package: Path, small: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    small.write_text(
        SMALL.replace('<mass value="0.8"/>', '<mass value="0"/>').replace("0.005", "0").replace('"0.1"', '"0"')
    )
    monkeypatch.setattr("sys.stdin", TypedAnswers("0\n0,4\n40 kg\n0.4\n\n"))
    assert main(["new", "base", "small", "--from", str(small)]) == 0
    out, told = capsys.readouterr()
    assert "how to measure it: on scales, with its battery" in told
    assert "Mass in kg (0.05 to 10000) [6]: " in out
    assert "'0', expected a number from 0.05 to 10000" in told
    assert "'0,4' is no number, expected one, as 0.4: mass in kg" in told
    assert "'40 kg' is no number, expected one without a unit: mass in kg" in told
    assert "stop: rests within 0.3 s and 0.13 m of its last command, from 0.5 m/s" in told
    assert "note: velocity 0.5 m/s and angular velocity 1.5 rad/s: usual, as neither" in told
    assert read_base(package / "bases" / "small" / "base.yaml", "small").mass == 0.4


def test_lidar_is_asked_for_with_yes_or_no(
    package: Path, small: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    small.write_text(SMALL.replace("base_scan", "plate").replace("<max>3.5</max>", "<max>0.3</max>"), encoding="utf-8")
    monkeypatch.setattr("sys.stdin", TypedAnswers("maybe\nY\n\n\n"))
    assert main(["new", "base", "small", "--from", str(small)]) == 0
    assert "error: 'maybe' is no answer, expected y or n" in capsys.readouterr().err
    assert read_base(package / "bases" / "small" / "base.yaml", "small").lidar is not None


def test_robot_without_a_lidar_is_told_how_to_drive(
    package: Path, small: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small.write_text(SMALL.replace("base_scan", "plate").replace("<max>3.5</max>", "<max>0.3</max>"), encoding="utf-8")
    assert main(["new", "base", "small", "--from", str(small)]) == 0
    assert "--lidar adds a typical one, and without it: ur run keyboard_drive" in capsys.readouterr().err
    assert (package / "bases" / "small" / "base.yaml").exists()


def test_speed_that_no_base_may_have_is_refused(package: Path, small: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "base", "small", "--from", str(small), "--velocity", "4"]) == 2
    told = capsys.readouterr().err
    assert "invalid --velocity '4', expected a number from 0.05 to 3" in told
    assert not (package / "bases").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["colour:=red"], "is no xacro file, which takes no argument 'colour:=red'"),
        (["red"], "unexpected argument 'red', expected ARG:=VALUE for 'small.urdf'"),
    ],
)
def test_argument_that_no_xacro_file_takes_is_refused(
    package: Path, small: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    assert main(["new", "base", "small", "--from", str(small), *words]) == 2
    assert message in capsys.readouterr().err
    assert main(["new", "base", "small", "--summary", "It drives.", "colour:=red"]) == 2
    assert "unexpected argument 'colour:=red', expected --from" in capsys.readouterr().err
    assert not (package / "bases").exists()


def test_base_in_a_workspace_of_its_own_is_found_by_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    (tmp_path / "meshes.urdf").write_text(MESHES, encoding="utf-8")
    words = ["--from", str(tmp_path / "meshes.urdf"), "--workspace", str(tmp_path / "own")]
    assert main(["new", "base", "meshes", *words]) == 0
    assert "ur use sim:meshes" in capsys.readouterr().err
    folder = find_base_package(LIBRARY, "meshes", os.environ)
    assert folder == tmp_path / "own/share/ubiquity_launches"
    base = load_base(folder, "meshes")
    names = {path.relative_to(LIBRARY).parts[0] for path in LIBRARY.glob("n_*/params/stage.yaml")}
    assert {path.relative_to(folder).parts[0] for path in folder.glob("n_*/params/meshes.yaml")} == names
    costmap = yaml.safe_load((folder / "n_local_costmap" / "params" / "meshes.yaml").read_text())["costmap"]
    assert [tuple(point) for point in costmap["footprint"]] == list(base.footprint)
    given = yaml.safe_load((folder / "n_velocity_smoother" / "params" / "meshes.yaml").read_text())
    assert given["speed_lim_v"] == base.limits.velocity
    assert given["accel_lim_v"] * given["decel_factor"] <= base.limits.deceleration
    assert main(["new", "base", "other", *words]) == 0, "a workspace holds several"
