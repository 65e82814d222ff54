"""The screen of `ur wifi`: everything fits, whatever the size of the terminal."""

from __future__ import annotations

import pytest

from ur.cli.robots.wifi_screen import describe_sample, render_screen
from ur.robot.doctor.wifi import WirelessLink
from ur.robot.wireless.sample import Sample

NAMES = ("laptop", "bob")
LINK = WirelessLink("wlan0", 5180.0, -60.0, 300.0)
WALK = [Sample(float(n), 5, 0, 0.002, LINK, LINK) for n in range(60)] + [
    Sample(60.0 + n, 5, 5, here=LINK) for n in range(8)
]


@pytest.mark.parametrize("size", [(120, 40), (80, 24), (60, 16), (200, 60)])
@pytest.mark.parametrize("samples", [WALK, [Sample(0.0)], [Sample(float(n), 5, 0, 0.001) for n in range(5)]])
def test_screen_fits_into_the_terminal(samples: list[Sample], size: tuple[int, int]) -> None:
    lines = render_screen(samples, NAMES, "no wireless interface at bob", *size).plain.splitlines()
    assert len(lines) <= size[1]
    assert max(map(len, lines)) <= size[0]


def test_screen_shows_both_signals_the_gap_and_what_to_do() -> None:
    text = render_screen(WALK, NAMES, "", 100, 40).plain
    assert "signal at laptop  -60 dBm, 300 Mbit/s, 5 GHz" in text
    assert "signal at bob  no signal" in text
    assert "latency  no answer" in text
    assert "×" in text  # noqa: RUF001 - the sign of a gap
    assert "bob has not answered for 8 s" in text


def test_signals_that_nobody_saw_take_no_room() -> None:
    assert "signal" not in render_screen([Sample(0.0, 5, 0, 0.001)], NAMES, "", 100, 40).plain


def test_line_says_everything_that_is_known() -> None:
    line = describe_sample(WALK[0], NAMES)
    assert line.endswith("latency 2.0 ms  loss 0%  laptop -60 dBm, 300 Mbit/s, 5 GHz  bob -60 dBm, 300 Mbit/s, 5 GHz")
    assert describe_sample(Sample(0.0, 5, 5), NAMES).endswith("latency no answer  loss 100%")
