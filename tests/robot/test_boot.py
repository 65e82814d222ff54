"""Boot units: systemd reads them, and the words of a command arrive as they were given."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from ur.robot.boot import is_unit_name, master_unit, program_unit

WORDS = ("rostopic", "pub", "/x", "std_msgs/String", "data: 'it''s 100%'", "$HOME", 'a "b" \\c')


def test_program_is_started_after_the_master_and_restarted_with_it() -> None:
    text = program_unit("drive", ["roslaunch", "p", "f"], "ros").text
    assert "After=network-online.target avahi-daemon.service ubiquity-master.service" in text
    assert "PartOf=ubiquity-master.service" in text
    assert "Restart=always" in text


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
def test_units_are_what_systemd_expects(tmp_path: Path) -> None:
    units = [master_unit("root"), program_unit("drive", WORDS, "root")]
    for unit in units:
        (tmp_path / f"{unit.service}.service").write_text(unit.text)
    paths = [str(tmp_path / f"{unit.service}.service") for unit in units]
    done = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", *paths], capture_output=True, text=True, check=False
    )
    complaints = [line for line in done.stderr.splitlines() if "ubiquity-" in line]
    assert complaints == []


@pytest.mark.parametrize(
    ("name", "good"), [("drive", True), ("m_nav-2", True), ("master", False), ("a b", False), ("../x", False)]
)
def test_unit_names_are_plain_words(name: str, good: bool) -> None:
    assert is_unit_name(name) is good
