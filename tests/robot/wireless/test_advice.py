"""One line of advice, from what was measured last."""

from dataclasses import replace

import pytest

from ur.robot.doctor.wifi import WirelessLink
from ur.robot.wireless.sample import Sample, advise

NAMES = ("laptop", "bob")
GOOD = Sample(0.0, 5, 0, 0.002)
LINK = WirelessLink("wlan0", 5180.0, -50.0, 400.0, power_save=False)
CROWDED = replace(LINK, frequency=2437.0)
LOSSY = Sample(0.0, 5, 1, 0.002)


@pytest.mark.parametrize(
    ("samples", "words"),
    [
        ([], "measuring"),
        ([Sample(0.0)], "measuring"),
        ([GOOD], "good"),
        ([replace(GOOD, here=LINK, there=LINK)], "good"),
        ([GOOD, Sample(1.0, 5, 5), Sample(2.0, 5, 5)], "bob has not answered for 2 s"),
        ([Sample(1.0, 5, 5)], "bob does not answer"),
        ([replace(GOOD, there=replace(LINK, signal=-80.0))], "the signal at bob is weak (-80 dBm)"),
        ([LOSSY], "20% are lost: what else uses the network?"),
        ([replace(LOSSY, here=CROWDED)], "5 GHz"),
        ([replace(LOSSY, here=LINK)], "another channel"),
        ([replace(GOOD, latency=0.3)], "packets wait"),
        ([replace(GOOD, latency=0.3, there=replace(LINK, power_save=True))], "bob saves power: ur doctor bob --fix"),
        ([replace(GOOD, here=replace(CROWDED, rate=6.0))], "laptop sends with 6 Mbit/s only: the 2.4 GHz band"),
    ],
)
def test_worst_comes_first(samples: list[Sample], words: str) -> None:
    assert words in advise(samples, NAMES)


def test_what_was_long_ago_is_forgotten() -> None:
    assert advise([LOSSY, *[GOOD] * 10], NAMES).startswith("good")
