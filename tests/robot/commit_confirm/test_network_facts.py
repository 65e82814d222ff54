"""What nmcli says, read."""

import pytest

from ur.robot.commit_confirm.network_facts import (
    NETPLAN,
    NetworkDevice,
    Profile,
    SeenNetwork,
    parse_networks,
    split_terse,
)

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
    assert networks.devices[3].owner == ""


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


NETPLANNED = """\
\x1erunning
\x1edevices
\x1eaddresses
wlan0            UP             192.168.1.7/24 metric 600
\x1eothers
systemd-networkd
\x1enetplan
/etc/netplan/50-cloud-init.yaml
\x1elinks
  1 lo    loopback carrier  unmanaged
  2 eth0  ether    no-carrier configuring
  3 wlan0 wlan     routable configured
\x1eusing
wlan0:L\\xc3\\xa4b
\x1enames
wlan0:Home
wlan0:Läb
docker0:Other
\x1eair
bssid / frequency / signal level / flags / ssid
02:00:00:00:00:01\t2437\t-60\t[WPA2-PSK-CCMP][ESS]\tL\\xc3\\xa4b
02:00:00:00:00:02\t5180\t-75\t[WPA2-PSK+SAE-CCMP][ESS]\tsaid \\"so\\"
02:00:00:00:00:03\t5180\t-110\t[WPA2-EAP-CCMP][ESS]\tOffice
02:00:00:00:00:04\t2412\t-30\t[WEP][ESS]\tOld
02:00:00:00:00:05\t2412\t-30\t[ESS]\tCafe
"""


def test_networks_of_netplan_are_read_from_networkctl_and_wpa_cli() -> None:
    networks = parse_networks(NETPLANNED)
    assert networks.wireless == NetworkDevice(
        "wlan0", "wifi", "routable (configured)", "Läb", ("192.168.1.7/24",), NETPLAN
    )
    assert [(each.name, each.kind, each.owner) for each in networks.devices[:2]] == [
        ("lo", "loopback", ""),
        ("eth0", "ethernet", NETPLAN),
    ]
    assert networks.profile("Home") == Profile("Home", "802-11-wireless", "wlan0", "Home", "Home")
    assert [(each.ssid, each.signal, each.security, each.used) for each in networks.seen] == [
        ("Läb", 80, "WPA2", True),
        ("Cafe", 100, "", False),
        ("Old", 100, "WEP", False),
        ('said "so"', 50, "WPA2 WPA3", False),
        ("Office", 0, "802.1X", False),
    ]


def test_networkd_without_netplan_owns_no_device_that_can_be_changed() -> None:
    networks = parse_networks(NETPLANNED.replace("/etc/netplan/50-cloud-init.yaml\n", ""))
    assert networks.wireless is None
    assert networks.others == ("systemd-networkd",)
