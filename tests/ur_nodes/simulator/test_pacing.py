import pytest

from ur_nodes.simulator.operation import Pacer


def test_pacer_waits_until_a_moment_is_due() -> None:
    pacer = Pacer(speed=2.0, time=10.0, now=100.0)
    assert pacer.wait(11.0, 100.1) == pytest.approx(0.4)
    assert pacer.wait(11.0, 100.6) == 0.0


def test_pacer_makes_up_for_a_short_delay() -> None:
    pacer = Pacer(speed=1.0, time=0.0, now=0.0)
    assert pacer.wait(1.0, 1.2) == 0.0
    assert pacer.due(1.5) == 1.5


def test_pacer_does_not_rush_after_a_stall() -> None:
    pacer = Pacer(speed=1.0, time=0.0, now=0.0)
    assert pacer.wait(1.0, 5.0) == 0.0
    assert pacer.wait(1.1, 5.0) == pytest.approx(0.1)


def test_pacer_without_a_speed_never_waits() -> None:
    assert Pacer(speed=0.0, time=0.0, now=0.0).wait(1000.0, 0.0) == 0.0
