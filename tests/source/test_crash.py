"""Reports of internal errors: where they are written, and that nobody else decides what they overwrite."""

import os
from pathlib import Path

import pytest

from ur.source.crash import write_crash_report

PROBLEM = ValueError("broken")


@pytest.fixture
def shared(tmp_path: Path) -> Path:
    """A folder that stands for /tmp, with a file of the user's beside it."""
    folder = tmp_path / "shared"
    folder.mkdir()
    (tmp_path / "mine").write_text("precious")
    return folder


@pytest.mark.parametrize("target", ["mine", "made"])
def test_crash_report_does_not_follow_a_link_that_somebody_has_put_there(
    shared: Path, tmp_path: Path, target: str
) -> None:
    place = shared / f"amcl-crash-{os.getpid()}-0000.log"
    place.symlink_to(tmp_path / target)
    assert write_crash_report(PROBLEM, "amcl", [], shared=shared, random=bytes) is None
    assert (tmp_path / "mine").read_text() == "precious"
    assert not (tmp_path / "made").exists()


def test_crash_report_goes_to_the_first_folder_that_takes_it(shared: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    refused = tmp_path / "file" / "no folder"
    kept = write_crash_report(PROBLEM, "amcl", [refused, tmp_path / "logs"], shared=shared)
    assert kept is not None
    assert kept.parent == tmp_path / "logs"
    last = write_crash_report(PROBLEM, "amcl", [refused], shared=shared)
    assert last is not None
    assert last.parent == shared


def test_crash_report_is_for_its_user_alone(shared: Path) -> None:
    report = write_crash_report(PROBLEM, "ur", [], ["check", "robot.launch"], shared=shared)
    assert report is not None
    assert report.parent == shared
    assert report.stat().st_mode & 0o777 == 0o600


def test_crash_report_holds_the_command_line_and_the_traceback(shared: Path) -> None:
    report = write_crash_report(PROBLEM, "ur", [], ["check", "robot.launch"], shared=shared)
    assert report is not None
    assert report.read_text().startswith("ur check robot.launch\n")
    assert "ValueError: broken" in report.read_text()
