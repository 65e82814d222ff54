from __future__ import annotations

from pathlib import Path

import pytest

from ur.cli.environment import PACKAGE
from ur.cli.programs import find_program, list_programs
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
    assert find_program(folder, name).path == folder / "ur_one"


@pytest.mark.parametrize("name", ["data", "other", "", "../x", "onne"])
def test_other_files_are_no_programs(folder: Path, name: str) -> None:
    with pytest.raises(UserError, match="expected one of one, two"):
        find_program(folder, name)


def test_our_programs_are_documented_and_have_a_name_for_rosrun() -> None:
    programs = list_programs(PACKAGE / "bin")
    nodes = {path.name for path in PACKAGE.glob("n_*/bin/*")}
    assert {"keyboard_drive", "keyboard_navigate"} <= {program.name for program in programs}
    for program in programs:
        assert program.summary
        assert "##Overview:" in program.path.read_text()
        if program.name not in nodes:  # roslaunch finds executables by name alone: a node's name is taken
            assert (PACKAGE / "bin" / program.name).resolve() == program.path.resolve()
