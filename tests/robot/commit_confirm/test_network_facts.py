"""What nmcli says, read."""

import pytest

from ur.robot.commit_confirm.network_facts import NetworkDevice, Profile, SeenNetwork, parse_networks, split_terse

SAID = """\
\x1erunning
/usr/bin/nmcli
active
\x1edevices
wlan0:wifi:connected:u-home
eth0:ethernet:unavailable:
lo:loopback:connected (externally):u-lo
docker0:bridge:unmanaged:
\x1eprofiles
u-home:802-11-wireless:wlan0:at home
u-lab:802-11-wireless::Lab\\: two
u-lo:loopback:lo:lo
\x1essids
u-home:Home
u-lab:Lab: two
\x1eaddresses
lo               UNKNOWN        127.0.0.1/8 ::1/128
wlan0@if3        UP             192.168.1.7/24 fe80::1/64
\x1eothers
systemd-networkd
\x1enetplan
\x1eseen
 :40:2437 MHz:WPA2:Home
*:72:5180 MHz:WPA2:Home
 :90:2412 MHz::Cafe\\: open
 :99:2412 MHz:WPA2:
 :55:5955 MHz:WPA3:Six
"""


def test_everything_is_read() -> None:
    networks = parse_networks(SAID.replace("/usr/bin/nmcli\n", ""))
    assert networks.running
    assert networks.devices[0] == NetworkDevice(
        "wlan0", "wifi", "connected", "u-home", ("192.168.1.7/24", "fe80::1/64")
    )
    assert networks.wireless is networks.devices[0]
    assert networks.profiles[1] == Profile("u-lab", "802-11-wireless", "", "Lab: two", "Lab: two")
    assert networks.others == ("systemd-networkd",)
    assert not networks.devices[3].managed


def test_stations_of_one_network_are_one_line_and_the_used_one_is_first() -> None:
    assert parse_networks(SAID).seen == (
        SeenNetwork("Home", 72, ("2.4 GHz", "5 GHz"), "WPA2", used=True),
        SeenNetwork("Cafe: open", 90, ("2.4 GHz",), ""),
        SeenNetwork("Six", 55, ("6 GHz",), "WPA3"),
    )


@pytest.mark.parametrize("address", ["192.168.1.7", "fe80::1", "fe80::1%wlan0"])
def test_device_is_found_by_the_address_that_leads_to_it(address: str) -> None:
    device = parse_networks(SAID).device_with(address)
    assert device
    assert device.name == "wlan0"
    assert parse_networks(SAID).device_with("192.168.1.70") is None


def test_computer_without_network_manager_says_so() -> None:
    networks = parse_networks("\x1erunning\n\x1edevices\n\x1eothers\ndhcpcd\n")
    assert not networks.running
    assert networks.wireless is None


@pytest.mark.parametrize(
    ("line", "fields"),
    [
        ("a:b", ["a", "b"]),
        ("a::", ["a", "", ""]),
        (":", ["", ""]),
        (r"a\:b:c\\:d", ["a:b", "c\\", "d"]),
        ("", [""]),
    ],
)
def test_terse_lines_are_split_at_plain_colons_only(line: str, fields: list[str]) -> None:
    assert split_terse(line) == fields
