"""Lines of `ur doctor --wireless`."""

from ur.cli.computer.wireless import describe_sample
from ur.robot.doctor.wifi import WirelessLink
from ur.robot.wireless.sample import Sample

NAMES = ("laptop", "bob")
LINK = WirelessLink("wlan0", 5180.0, -60.0, 300.0)


def test_line_says_everything_that_is_known() -> None:
    line = describe_sample(Sample(0.0, 5, 0, 0.002, LINK, LINK), NAMES)
    assert line.endswith("latency 2.0 ms  loss 0%  laptop -60 dBm, 300 Mbit/s, 5 GHz  bob -60 dBm, 300 Mbit/s, 5 GHz")
    assert describe_sample(Sample(0.0, 5, 5), NAMES).endswith("latency no answer  loss 100%")
