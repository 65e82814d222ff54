"""The look-up of releases in package lists: its logic, without a network."""

from pathlib import Path

import pytest
from tools.check_releases import (
    CheckError,
    choose_releases,
    list_missing,
    main,
    parse_candidates,
    read_sources,
    rewrite_sources,
)

from ur.system.releases import System, load_ros_packages

DEBIAN = System("debian", version="12", codename="bookworm", name="Debian 12")
POLICY = """\
rosbash:
  Installed: (none)
  Candidate: 1.15.8-3
  Version table:
     1.15.8-3 500
        500 http://mirror/debian bookworm/main amd64 Packages
robot-state-publisher:
  Installed: (none)
  Candidate: (none)
  Version table:
"""


def test_candidates_are_the_packages_that_can_be_installed() -> None:
    assert parse_candidates(POLICY) == {"rosbash": "1.15.8-3"}
    assert parse_candidates("") == {}


@pytest.mark.parametrize(
    ("candidates", "missing"),
    [
        ({"a", "c", "rviz"}, ()),
        ({"a", "b", "rviz"}, ()),
        ({"a", "b"}, ("rviz",)),
        ({"b", "rviz"}, ("a",)),
        ({"a"}, ("b", "rviz")),
        ({"rviz"}, ("all",)),
        (set(), ("all", "rviz")),
    ],
)
def test_entry_is_missing_where_no_alternative_has_a_candidate(candidates: set[str], missing: tuple[str, ...]) -> None:
    assert list_missing(["a", "b|c"], candidates) == missing


def test_ros_packages_hold_nothing_that_debian_14_lacks() -> None:
    names = {name for entry in load_ros_packages() for name in entry.split("|")}
    assert names.isdisjoint({"ros-core", "ros-base", "rviz"})


def test_sources_of_one_release_become_those_of_another() -> None:
    text = "Suites: bookworm bookworm-updates\nSigned-By: /x-bookworm.gpg\n"
    assert rewrite_sources(text, "bookworm", "trixie") == "Suites: trixie trixie-updates\nSigned-By: /x-bookworm.gpg\n"
    assert rewrite_sources(text, "", "trixie") == text


def test_without_a_name_all_releases_of_the_own_distribution_are_chosen() -> None:
    assert [row.codename for row in choose_releases([], DEBIAN, sources=False)] == ["bookworm", "trixie", "forky"]
    assert [row.codename for row in choose_releases(["noble"], DEBIAN, sources=True)] == ["noble"]


@pytest.mark.parametrize(
    ("name", "message"),
    [("nobel", "unknown release 'nobel', expected one of"), ("noble", "Ubuntu 24.04: its lists are not those of")],
)
def test_release_that_cannot_be_looked_up_is_refused(name: str, message: str) -> None:
    with pytest.raises(CheckError, match=message):
        choose_releases([name], DEBIAN, sources=False)


def test_missing_sources_are_an_error_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(CheckError, match="no apt sources found"):
        read_sources(tmp_path / "none")
    assert main(["noble", "--sources", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err == f"error: no apt sources found, expected {tmp_path / 'none'}\n"
