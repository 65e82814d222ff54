"""Rates and bandwidths of topics."""

import pytest

from ur_nodes.web.data.topics import RateMeter


def test_rate_and_bandwidth_are_those_of_the_last_seconds() -> None:
    meter = RateMeter(0.0)
    for number in range(200):
        meter.note(number * 0.1, 50)
    assert meter.measure(20.0) == pytest.approx((10.0, 500.0), rel=0.05)
    assert meter.measure(30.0) == (0.0, 0.0)


def test_rate_of_many_messages_is_that_of_those_that_are_counted() -> None:
    meter = RateMeter(0.0)
    for number in range(6000):
        meter.note(number * 0.0005, 1)
    assert meter.measure(3.0)[0] == pytest.approx(2000.0, rel=0.01)
