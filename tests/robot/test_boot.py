"""Boot units: systemd reads them, and the words of a command arrive as they were given."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from ur.robot.boot import is_unit_name, master_unit, program_unit, tell_base_script

WORDS = ("rostopic", "pub", "/x", "std_msgs/String", "data: 'it''s 100%'", "$HOME", 'a "b" \\c')


def test_program_is_started_after_the_master_and_restarted_with_it() -> None:
    text = program_unit("drive", ["roslaunch", "p", "f"], "ros").text
    assert "After=network-online.target avahi-daemon.service ubiquity-master.service" in text
    assert "PartOf=ubiquity-master.service" in text
    assert "Restart=always" in text


def run_script(path: Path) -> subprocess.CompletedProcess[str]:
    script = tell_base_script(path)
    return subprocess.run(["/usr/bin/python3", "-c", script], capture_output=True, text=True, check=False, timeout=90)


def test_master_is_told_the_base_before_programs_start() -> None:
    text = master_unit("ros").text
    assert text.index("ExecStart=") < text.index("ExecStartPost=-") < text.index("[Install]")
    assert "/ur/base_name" in text
    assert "ExecStartPost" not in program_unit("drive", ["roslaunch", "p", "f"], "ros").text


def test_computer_without_a_robot_file_tells_nothing(tmp_path: Path) -> None:
    done = run_script(tmp_path / "none.yaml")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("text", ["name: bob\n", "[1, 2\n", "3\n"])
def test_robot_file_that_cannot_be_used_is_named_in_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    done = run_script(path)
    assert done.returncode == 1
    assert done.stderr.startswith(f"{path}: ")
    assert "Traceback" not in done.stderr


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
