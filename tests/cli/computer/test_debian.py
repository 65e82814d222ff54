from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from ur.cli.main import main
from ur.debian.root import DebianRoot
from ur.request.environment import REPOSITORY, environment_changes
from ur.request.requirements.debian_packages import install_debian
from ur.robot.selection import parse_selection
from ur.source.diagnostic import UserError

SCRIPT = REPOSITORY / "tools" / "debian_root.bash"


def run_script(*words: str, data: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", SCRIPT, *words],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "XDG_DATA_HOME": str(data)},
    )


@pytest.mark.parametrize("words", [["install", "gdb"], ["update"], ["remove"]])
def test_changing_the_root_from_inside_is_refused_with_the_command_to_use(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mark").touch()
    monkeypatch.setattr("ur.cli.computer.debian.MARK", str(tmp_path / "mark"))
    assert main(["debian", *words]) == 2
    said = capsys.readouterr().err
    assert "cannot run inside the Debian root" in said
    assert f"/ur debian {' '.join(words)}" in said


def test_missing_packages_are_refused_inside_with_the_command_that_installs_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "dpkg-query").write_text("#!/bin/sh\n")
    (tmp_path / "dpkg-query").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    monkeypatch.setattr("ur.request.requirements.debian_packages.find_root", lambda _: DebianRoot("/data", "13"))
    command = "ur.request.requirements.debian_packages.install_command"
    monkeypatch.setattr(command, lambda names: f"install {' '.join(names)}")
    with pytest.raises(UserError) as caught:
        install_debian([["gdb"]], "a debugger")
    assert caught.value.diagnostics[0].help == "install gdb"


def test_shells_find_the_programs_of_the_root_after_those_of_the_project(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ur.request.environment.find_root", lambda _: DebianRoot("/data", "13"))
    package = Path("/project/ubiquity_launches")
    changes = environment_changes(parse_selection("sim:stage"), {"PATH": "/usr/bin"}, package=package)
    assert changes["PATH"] == "/project/ubiquity_launches/bin:/data/bin:/usr/bin"
    again = environment_changes(parse_selection("sim:stage"), {"PATH": changes["PATH"]}, package=package)
    assert again["PATH"] == changes["PATH"]


def test_status_without_a_root_says_so(tmp_path: Path) -> None:
    done = run_script("status", data=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("no Debian root")


def test_unknown_command_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    done = run_script("remvoe", data=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("error: unknown command 'remvoe'")
    assert "remove" in done.stderr


def test_entering_without_a_root_names_the_command_that_makes_it(tmp_path: Path) -> None:
    done = run_script("enter", "true", data=tmp_path)
    assert done.returncode == 2
    assert "does not exist" in done.stderr
    assert "help: " in done.stderr


def test_remove_deletes_the_folder_and_keeps_what_others_have_in_the_one_above(tmp_path: Path) -> None:
    data = tmp_path / "ubiquity_launches/debian-13"
    (data / "partial").mkdir(parents=True)
    (data.parent / "waypoints").touch()
    done = run_script("remove", data=tmp_path)
    assert done.returncode == 0, done.stderr
    assert [each.name for each in data.parent.iterdir()] == ["waypoints"]


def test_folder_with_a_mount_in_it_is_neither_deleted_nor_given_away(tmp_path: Path) -> None:
    line = f'. {SCRIPT}; is_free / || echo mounted; is_free "$1" && echo free'
    done = subprocess.run(["bash", "-c", line, "bash", tmp_path], capture_output=True, text=True, check=False)
    assert done.stdout == "mounted\nfree\n"
