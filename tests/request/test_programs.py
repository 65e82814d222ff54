from pathlib import Path

import pytest

from ur.request.programs import PACKAGE, choose_program, find_launch_file, find_program, index_programs, list_programs
from ur.source import UserError


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, mode in (("ur_one", 0o755), ("ur_two", 0o755), ("ur_data", 0o644), ("other", 0o755)):
        (tmp_path / name).write_text(f"#!/bin/bash\n##Summary: Does {name}.\n")
        (tmp_path / name).chmod(mode)
    return tmp_path


def test_programs_are_executables_with_a_summary(folder: Path) -> None:
    assert [(each.name, each.summary) for each in list_programs(folder)] == [
        ("one", "Does ur_one."),
        ("two", "Does ur_two."),
    ]


@pytest.mark.parametrize("name", ["one", "ur_one"])
def test_program_is_found_with_and_without_prefix(folder: Path, name: str) -> None:
    assert choose_program(list_programs(folder), name).path == folder / "ur_one"


@pytest.mark.parametrize("name", ["data", "other", "", "../x", "onne"])
def test_other_files_are_no_programs(folder: Path, name: str) -> None:
    with pytest.raises(UserError, match="expected one of one, two"):
        choose_program(list_programs(folder), name)


def test_our_programs_are_documented_and_have_a_name_for_rosrun() -> None:
    programs = list_programs(PACKAGE / "bin")
    nodes = {path.name for path in PACKAGE.glob("n_*/bin/*")}
    assert {"keyboard_drive", "keyboard_navigate"} <= {program.name for program in programs}
    for program in programs:
        assert program.summary
        assert "##Overview:" in program.path.read_text()
        if program.name not in nodes:  # roslaunch finds executables by name alone: a node's name is taken
            assert (PACKAGE / "bin" / program.name).resolve() == program.path.resolve()


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """Two packages with programs: `wander` in one, `robot_base` and `wander` in the other."""
    for package, names in (("my_robot", ("wander",)), ("other_robot", ("robot_base", "wander"))):
        folder = tmp_path / package
        (folder / "bin").mkdir(parents=True)
        (folder / "package.xml").write_text(f"<package><name>{package}</name></package>")
        (folder / "m_wander" / "launch").mkdir(parents=True)
        (folder / "m_wander" / "launch" / "m_wander.launch.xml").write_text("<launch/>")
        for name in names:
            path = folder / "bin" / f"ur_{name}"
            path.write_text(f'##Summary: {name}.\nexec ur launch {package} m_wander.launch.xml "$@"\n')
            path.chmod(0o755)
    return tmp_path


def test_programs_of_every_package_on_the_path_are_known_the_librarys_first(workspace: Path) -> None:
    index = index_programs(PACKAGE, {"ROS_PACKAGE_PATH": str(workspace)})
    assert not index.problem
    assert list(dict.fromkeys(each.package for each in index.programs)) == [PACKAGE.name, "my_robot", "other_robot"]
    (program,) = (each for each in index.programs if each.package == "my_robot")
    assert program.path == workspace / "my_robot" / "bin" / "ur_wander"
    assert find_launch_file(program) == workspace / "my_robot/m_wander/launch/m_wander.launch.xml"


def test_name_that_several_packages_use_needs_its_package(workspace: Path) -> None:
    programs = index_programs(PACKAGE, {"ROS_PACKAGE_PATH": str(workspace)}).programs
    with pytest.raises(UserError, match="is in my_robot and other_robot, expected PACKAGE/PROGRAM") as caught:
        choose_program(programs, "wander")
    assert caught.value.diagnostics[0].help == "ur run my_robot/wander or ur run other_robot/wander"
    assert choose_program(programs, "other_robot/ur_wander").package == "other_robot"


def test_broken_package_leaves_the_programs_of_the_library(workspace: Path) -> None:
    (workspace / "my_robot" / "package.xml").write_text("<package>")
    index = index_programs(PACKAGE, {"ROS_PACKAGE_PATH": str(workspace)})
    assert {each.package for each in index.programs} == {PACKAGE.name}
    assert "my_robot/package.xml" in index.problem
    with pytest.raises(UserError, match="unknown program 'wander'") as caught:
        choose_program(index.programs, "wander", index.problem)
    assert "my_robot/package.xml" in str(caught.value.diagnostics[0].help)


def test_program_of_a_package_that_ros_does_not_find_says_what_to_set(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(workspace / "my_robot" / "m_wander")
    with pytest.raises(UserError, match="package 'my_robot' is not on ROS_PACKAGE_PATH") as caught:
        find_program(PACKAGE, "wander", {})
    assert caught.value.diagnostics[0].help == f'export ROS_PACKAGE_PATH="{workspace}:$ROS_PACKAGE_PATH"'
    monkeypatch.chdir(workspace)
    assert find_program(PACKAGE, "my_robot/wander", {"ROS_PACKAGE_PATH": str(workspace)}).package == "my_robot"
