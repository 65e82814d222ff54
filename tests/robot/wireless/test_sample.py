"""What ping says, second by second."""

import pytest

from ur.robot.doctor.wifi import WirelessLink
from ur.robot.wireless.sample import COLUMNS, Echoes, Sample, render_row, summarize


def take(echoes: Echoes) -> tuple[int, int, float | None]:
    """With the latency in ms."""
    sent, lost, latency = echoes.pop()
    return sent, lost, None if latency is None else round(latency * 1000, 6)


def reply(number: int, milliseconds: float) -> str:
    return f"64 bytes from 10.0.0.2: icmp_seq={number} ttl=64 time={milliseconds} ms"


def test_echoes_count_once_they_are_a_second_old() -> None:
    echoes = Echoes()
    for number in range(1, 11):
        echoes.read(reply(number, number))
    assert take(echoes) == (5, 0, 3.0)
    assert echoes.pop() == (0, 0, None)


@pytest.mark.parametrize(
    "missing",
    ["no answer yet for icmp_seq=2", "From 10.0.0.1 icmp_seq=2 Destination Host Unreachable", "PING 10.0.0.2"],
)
def test_echo_that_does_not_come_is_lost(missing: str) -> None:
    echoes = Echoes()
    for line in (reply(1, 1.0), missing, reply(3, 3.0), reply(8, 1.0)):
        echoes.read(line)
    assert take(echoes) == (3, 1, 2.0)


def test_late_echo_counts_unless_a_second_has_passed() -> None:
    echoes = Echoes()
    for line in (reply(1, 1.0), "no answer yet for icmp_seq=2", reply(2, 300.0), reply(7, 1.0)):
        echoes.read(line)
    assert echoes.pop()[:2] == (2, 0)
    echoes.read(reply(2, 5000.0))
    for number in range(8, 13):
        echoes.read(reply(number, 1.0))
    assert take(echoes) == (5, 4, 1.0)  # 3 to 6 never came


def test_seconds_without_an_answer_are_gaps() -> None:
    assert Sample(0.0, 5, 5).gap
    assert Sample(0.0).loss == 1.0
    assert not Sample(0.0, 5, 4, 0.1).gap


def test_summary_counts_what_was_and_how_often_it_was_away() -> None:
    weak, strong = WirelessLink("wlan0", signal=-80.0), WirelessLink("wlan0", signal=-50.0)
    samples = [
        Sample(0.0, 5, 0, 0.001, strong),
        Sample(1.0, 5, 5),
        Sample(2.0, 5, 5),
        Sample(3.0, 5, 0, 0.003, weak),
        Sample(4.0, 5, 0, 0.002, strong),
        Sample(5.0, 0, 0),
    ]
    whole = summarize(samples)
    assert (whole.seconds, whole.gaps) == (6, 2)
    assert whole.loss == pytest.approx(0.4)
    assert whole.latency == (0.001, 0.002, 0.003)
    assert (whole.here, whole.there) == ((-80.0, -50.0), None)
    assert summarize([Sample(0.0)]).latency is None


def test_row_of_a_log_has_every_column_also_where_nothing_was_seen() -> None:
    sample = Sample(1_700_000_000.5, 5, 1, 0.0042, WirelessLink("wlan0", 5180.0, -52.0, 433.3))
    row = render_row(sample, 1_700_000_000.0)
    assert row == "2023-11-14T22:13:20.500+00:00,0.5,5,1,4.200,wlan0,-52,433.3,5180,,,,\n"
    assert row.count(",") == render_row(Sample(0.0), 0.0).count(",") == len(COLUMNS) - 1
