"""What iw and the kernel say of wireless links."""

import subprocess

import pytest

from ur.robot.doctor.wifi import WIFI_SCRIPT, WirelessLink, parse_wifi

LINK = """\
Connected to 02:00:00:00:00:01 (on wlan0)
\tSSID: signal: -1 dBm
\tfreq: 5180.0
\tRX: 1200 bytes (9 packets)
\tsignal: -52 dBm
\trx bitrate: 390.0 MBit/s VHT-MCS 9 80MHz short GI VHT-NSS 1
\ttx bitrate: 433.3 MBit/s VHT-MCS 9 80MHz short GI VHT-NSS 1
"""
KERNEL = " wlan0: 0000   54.  -56.  -256        0      0      0      0      0        0\n"


@pytest.mark.parametrize(
    ("said", "wanted"),
    [
        ("", ()),
        ("device wlan0\n", ()),
        ("device wlan0\nNot connected.\nPower save: on\n", ()),
        (
            f"device wlan0\n{LINK}Power save: on\n{KERNEL}",
            (WirelessLink("wlan0", 5180.0, -52.0, 433.3, power_save=True),),
        ),
        (f"device wlan0\n{LINK}Power save: off\n", (WirelessLink("wlan0", 5180.0, -52.0, 433.3, power_save=False),)),
        (f"device wlan0\n{KERNEL}", (WirelessLink("wlan0", signal=-56.0),)),
        (
            "device wlan0\nNot connected.\ndevice wlx1\n\tfreq: 2437\n\tsignal: -71 dBm\n\ttx bitrate: 6.0 MBit/s\n",
            (WirelessLink("wlx1", 2437.0, -71.0, 6.0),),
        ),
    ],
)
def test_links_are_read(said: str, wanted: tuple[WirelessLink, ...]) -> None:
    assert parse_wifi(said) == wanted


@pytest.mark.parametrize(
    ("frequency", "band"), [(None, ""), (2437.0, "2.4 GHz"), (5180.0, "5 GHz"), (5885.0, "5 GHz"), (5955.0, "6 GHz")]
)
def test_band_follows_from_the_frequency(frequency: float | None, band: str) -> None:
    assert WirelessLink("wlan0", frequency).band == band


def test_script_runs_in_a_plain_shell() -> None:
    done = subprocess.run(["sh", "-eu", "-c", f"{WIFI_SCRIPT}\necho end"], capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert done.stdout.endswith("end\n")
