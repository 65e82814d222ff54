"""Figures of a computer from the texts of its files."""

from pathlib import Path
from typing import Any

import pytest

from ur_nodes.web.status.computer import ComputerTexts, CpuTimes, describe_computer, read_times, share_used
from ur_nodes.web.status.computer_files import read_computer, read_disk

WIRELESS = """Inter-| sta-|   Quality        |   Discarded packets               | Missed | WE
 face | tus | link level noise |  nwid  crypt   frag  retry   misc | beacon | 22
 wlan0: 0000   55.  -55.  -256        0      0      0      0     12        0
  old0: 0000   30.  196.  0        0      0      0      0     12        0
"""


def test_figures_are_read() -> None:
    texts = ComputerTexts(
        meminfo="MemTotal:  1000 kB\nMemFree: 1 kB\nMemAvailable:    400 kB\n",
        loadavg="0.52 0.58 0.59 1/467 12345\n",
        uptime="3600.52 7000.0\n",
        wireless=WIRELESS,
        zones=(("cpu-thermal\n", "48312\n"), ("broken", "-274000\n"), ("empty", "")),
    )
    assert describe_computer(texts) == {
        "memory": [600 * 1024, 1000 * 1024],
        "load": 0.52,
        "uptime": 3601,
        "temperatures": [["cpu-thermal", 48.3]],
        "wireless": [["wlan0", -55.0, 55.0], ["old0", -60.0, 30.0]],
    }


def test_share_of_the_processors_is_that_between_two_readings() -> None:
    before, after = read_times("cpu  100 0 100 700 100 0 0 0 0 0\n"), read_times("cpu  200 0 200 1350 150 0 0 0\n")
    assert before == CpuTimes(1000, 800)
    assert share_used(before, after) == pytest.approx(200 / 900)
    assert share_used(CpuTimes(), after) is None
    assert share_used(after, after) is None


@pytest.mark.parametrize("text", ["", "cpu", "cpu x y", "nan", "inf", "\x00" * 50, "MemTotal: -5 kB"])
def test_files_that_say_nothing_give_no_figures(text: str) -> None:
    assert describe_computer(ComputerTexts(text, text, text, text, text, ((text, text),))) == {}
    assert read_times(text) == CpuTimes()


def test_files_of_this_computer_are_read_and_missing_ones_are_empty(tmp_path: Path) -> None:
    found: Any = describe_computer(read_computer())
    assert found["memory"][1] > 0
    assert read_computer(tmp_path) == ComputerTexts()
    disk = read_disk(tmp_path)
    assert disk is not None
    assert 0 < disk[0] <= disk[1]
    assert read_disk(tmp_path / "missing") is None
