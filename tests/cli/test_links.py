"""Links that lead out of a package are left out, whatever they lead to, and that is said once."""

import re
from pathlib import Path

import pytest

from ur.cli.main import main

MANIFEST = (
    '<package format="2">\n  <name>{0}</name>\n  <version>1.0.0</version>\n  <description>d</description>\n'
    '  <maintainer email="a@b.c">m</maintainer>\n  <license>BSD</license>\n</package>\n'
)
UGLY = '<launch><node name="a"   pkg="p" type="t"/></launch>\n'


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A package of the user, which nobody asked to be changed."""
    folder = tmp_path / "mine"
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.format("mine"))
    (folder / "launch/mine.launch").write_text(UGLY)
    return folder


@pytest.fixture
def foreign(tmp_path: Path, mine: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package that was downloaded, in the current folder, with links to the other one."""
    folder = tmp_path / "foreign"
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.format("foreign"))
    (folder / "launch/own.launch").write_text(UGLY)
    (folder / "launch/second.launch").symlink_to("own.launch")
    (folder / "launch/file.launch").symlink_to(mine / "launch/mine.launch")
    (folder / "folder").symlink_to(mine / "launch")
    (folder / "package").symlink_to(mine)
    monkeypatch.chdir(folder)
    return folder


def count_notes(text: str) -> int:
    return len(
        re.findall(r"(3|4) links lead out of what is checked and are left out: folder, launch/file\.launch, ", text)
    )


@pytest.mark.usefixtures("foreign")
def test_check_leaves_them_out(capsys: pytest.CaptureFixture[str]) -> None:
    main(["check", "."])
    said = capsys.readouterr()
    assert count_notes(said.err) == 1
    assert "mine" not in said.out


def test_format_leaves_them_out(mine: Path, foreign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["format", "."]) == 0
    assert count_notes(capsys.readouterr().err) == 1
    assert (mine / "launch/mine.launch").read_text() == UGLY
    assert (foreign / "launch/own.launch").read_text() != UGLY
    assert (foreign / "launch/second.launch").is_symlink()


def test_docs_leave_them_out(mine: Path, foreign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    victim = mine / "launch/mine.launch"
    (foreign / "launches.md").symlink_to(victim)
    assert main(["docs", "."]) == 0
    assert count_notes(capsys.readouterr().err) == 1
    assert victim.read_text() == UGLY
    assert not (foreign / "launches.md").is_symlink()
    assert "mine.launch" not in (foreign / "launches.md").read_text()


def test_package_is_not_written_through_a_link_that_leads_out(
    mine: Path, foreign: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (foreign / "CMakeLists.txt").symlink_to(mine / "new")
    assert main(["check", "--package", "--fix", "."]) == 2
    assert "CMakeLists.txt is a link that leads out of the package" in capsys.readouterr().err
    assert not (mine / "new").exists()


def test_workspace_may_hold_links_to_packages(
    tmp_path: Path, mine: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "ws" / "src"
    source.mkdir(parents=True)
    (source / "mine").symlink_to(mine)
    monkeypatch.chdir(source)
    assert main(["format", "."]) == 0
    assert "left out" not in capsys.readouterr().err
    assert (mine / "launch/mine.launch").read_text() != UGLY


def test_file_that_is_named_is_checked_wherever_it_leads(foreign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["check", "launch/file.launch"])
    assert "in 1 file" in capsys.readouterr().out
    assert foreign.is_dir()


def test_link_to_what_is_never_checked_is_not_worth_a_note(
    tmp_path: Path, mine: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "start").write_text("#!/bin/bash\n")
    (mine / "bin").mkdir()
    (mine / "bin/start").symlink_to(tmp_path / "start")
    monkeypatch.chdir(mine)
    main(["check", "."])
    assert "note:" not in capsys.readouterr().err
