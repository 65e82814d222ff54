"""Reports of internal errors: where they are written, and that nobody else decides what they overwrite."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

from ur.cli.defects import write_defect
from ur.source.crash import write_crash_report

PROBLEM = ValueError("broken")


@pytest.fixture
def shared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that stands for /tmp, with a file of the user's beside it."""
    folder = tmp_path / "shared"
    folder.mkdir()
    (tmp_path / "mine").write_text("precious")
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def test_crash_report_does_not_follow_a_link_that_somebody_has_put_there(shared: Path, tmp_path: Path) -> None:
    place = shared / f"amcl-crash-{os.getpid()}.log"
    place.symlink_to(tmp_path / "mine")
    (tmp_path / "file").write_text("")
    report = write_crash_report(PROBLEM, "amcl", [tmp_path / "file" / "no folder"])
    assert report == place
    assert not place.is_symlink()
    assert "ValueError: broken" in place.read_text()
    assert (tmp_path / "mine").read_text() == "precious"


def test_crash_report_makes_no_file_at_the_end_of_a_dangling_link(shared: Path, tmp_path: Path) -> None:
    (shared / f"amcl-crash-{os.getpid()}.log").symlink_to(tmp_path / "made")
    assert write_crash_report(PROBLEM, "amcl", []) is not None
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize("target", ["mine", "made"])
def test_report_of_a_defect_does_not_follow_a_link_even_under_the_right_name(
    shared: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, target: str
) -> None:
    monkeypatch.setattr(os, "urandom", bytes)  # what nobody can guess
    place = shared / f"ur-defect-{os.getpid()}-0000.log"
    place.symlink_to(tmp_path / target)
    assert write_defect(PROBLEM, ["check"], {"XDG_STATE_HOME": "/proc/nowhere"}) is None
    assert (tmp_path / "mine").read_text() == "precious"
    assert not (tmp_path / "made").exists()


def test_report_of_a_defect_is_for_its_user_alone(shared: Path) -> None:
    report = write_defect(PROBLEM, ["check"], {"XDG_STATE_HOME": "/proc/nowhere"})
    assert report is not None
    assert report.parent == shared
    assert report.stat().st_mode & 0o777 == 0o600
