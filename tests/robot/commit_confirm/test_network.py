"""Profiles, addresses and the commands for NetworkManager; what is refused."""

import pytest

from ur.robot.commit_confirm.guarded import list_changes
from ur.robot.commit_confirm.network import (
    KEPT,
    NetworkManager,
    WirelessNetwork,
    check_managed,
    check_password,
    choose_management,
    find_profile,
    parse_addressing,
    render_profile,
)
from ur.robot.commit_confirm.network_facts import NetworkDevice, Networks, Profile, SeenNetwork
from ur.robot.setup.facts import ComputerFacts
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError

HOME = Profile("u-home", "802-11-wireless", "wlan0", "at home", "Home")
WIRED = Profile("u-wired", "802-3-ethernet", "eth0", "wired")
WLAN = NetworkDevice("wlan0", "wifi", "connected", "u-home", ("192.168.1.7/24",))
NETWORKS = Networks(True, (WLAN, NetworkDevice("eth0", "ethernet", "connected", "u-wired")), (HOME, WIRED))
FACTS = ComputerFacts("ros", "/home/ros", "bob", "", "1", frozenset())


def test_password_stands_in_the_profile_and_nowhere_else() -> None:
    change = NetworkManager(NETWORKS).join(WirelessNetwork("Lab", Secret("pass word"), "wpa-psk"), WLAN)
    (planned,) = list_changes(change, FACTS)
    (command,) = planned.commands
    assert isinstance(command.stdin, Secret)
    assert "psk=pass word\n" in command.stdin.reveal()
    assert "pass word" not in repr((planned, change)) + command.script + change.live + change.back


def test_profile_is_preferred_over_those_that_stay() -> None:
    text = render_profile(WirelessNetwork("Lab", Secret("12345678"), "sae", hidden=True, band="5"))
    for line in ("autoconnect-priority=10", "hidden=true", "band=a", "key-mgmt=sae", "ssid=76;97;98;"):
        assert f"\n{line}\n" in text


@pytest.mark.parametrize(
    ("password", "line"),
    [
        ("plain-one", "psk=plain-one"),
        (" blanks ", "psk=\\sblanks\\s"),
        ("back\\slash", "psk=back\\\\slash"),
        ("semi;colon=#", "psk=semi;colon=#"),
        ("        ", "psk=" + "\\s" * 8),
    ],
)
def test_password_is_escaped_as_key_files_want_it(password: str, line: str) -> None:
    assert f"\n{line}\n" in render_profile(WirelessNetwork("Lab", Secret(password), "wpa-psk"))


@pytest.mark.parametrize("breaks", ["\n", "\r", "\r\n"])
def test_line_break_in_the_name_of_a_network_adds_no_line_to_its_profile(breaks: str) -> None:
    evil = f"Lab{breaks}[connection]{breaks}permissions=user:mallory:;{breaks}"
    plain = render_profile(WirelessNetwork("Lab", Secret("12345678"), "wpa-psk")).splitlines()
    text = render_profile(WirelessNetwork(evil, Secret("12345678"), "wpa-psk"))
    assert [line.partition("=")[0] for line in text.splitlines()] == [line.partition("=")[0] for line in plain]
    assert f"\nid=Lab{repr(breaks)[1:-1]}[connection]" in text


def test_open_network_has_no_security() -> None:
    assert "security" not in render_profile(WirelessNetwork("Café", None, ""))
    assert "ssid=67;97;102;195;169;" in render_profile(WirelessNetwork("Café", None, ""))


def test_known_network_is_joined_by_its_own_profile_without_a_password() -> None:
    change = NetworkManager(NETWORKS).join(WirelessNetwork("Home", None, "wpa-psk"), WLAN)
    assert list_changes(change, FACTS) == []
    assert "connection up uuid u-home ifname wlan0" in change.live


def test_new_password_of_a_known_network_makes_a_profile() -> None:
    wifi = WirelessNetwork("Home", Secret("12345678"), "wpa-psk")
    change = NetworkManager(NETWORKS).join(wifi, WLAN)
    assert len(list_changes(change, FACTS)) == 1
    assert f"connection up uuid {wifi.uuid}" in change.live


def test_way_back_brings_up_what_was_used_and_keeps_all_profiles() -> None:
    change = NetworkManager(NETWORKS).forget(HOME)
    assert "nmcli connection delete u-home" in change.live
    assert "up uuid u-home ifname wlan0" in change.back
    assert "up uuid u-wired ifname eth0" in change.back
    assert change.also_kept == KEPT
    assert "netplan generate" in change.early  # its profiles were made of the changed files before the guard ran


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("10.0.0.7/24", None, ()), "ipv4.method manual ipv4.addresses 10.0.0.7/24 ipv4.gateway '' ipv4.dns ''"),
        (
            ("10.0.0.7/24", "10.0.0.1", ("1.1.1.1", "9.9.9.9")),
            "ipv4.method manual ipv4.addresses 10.0.0.7/24 ipv4.gateway 10.0.0.1 ipv4.dns '1.1.1.1 9.9.9.9'",
        ),
        ((None, None, ()), "ipv4.method auto ipv4.addresses '' ipv4.gateway '' ipv4.dns ''"),
    ],
)
def test_address_is_set_on_the_profile_of_the_device(
    options: tuple[str | None, str | None, tuple[str, ...]], words: str
) -> None:
    address, gateway, names = options
    wanted = parse_addressing(address, gateway, names, dhcp=address is None)
    change = NetworkManager(NETWORKS).address(NETWORKS.devices[1], wanted)
    assert change.live.splitlines()[2:] == [
        f"nmcli connection modify u-wired {words}",
        "nmcli --wait 40 connection up uuid u-wired ifname eth0",
    ]


@pytest.mark.parametrize(
    ("address", "gateway", "names", "said"),
    [
        ("10.0.0.7", None, (), "--address '10.0.0.7'"),
        ("10.0.0.300/24", None, (), "--address"),
        ("10.0.0.0/24", None, (), "not a host address"),
        ("10.0.0.255/24", None, (), "not a host address"),
        ("10.0.0.7/24", "10.0.1.1", (), "--gateway 10.0.1.1 is not in the network 10.0.0.0/24"),
        ("10.0.0.7/24", "there", (), "--gateway 'there'"),
        ("10.0.0.7/24", None, ("dns.example",), "--dns 'dns.example'"),
    ],
)
def test_address_that_cannot_be_is_named(address: str, gateway: str | None, names: tuple[str, ...], said: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_addressing(address, gateway, names, dhcp=False)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("security", "management"),
    [
        ("", ""),
        ("WPA2", "wpa-psk"),
        ("WPA1 WPA2", "wpa-psk"),
        ("WPA2 WPA3", "wpa-psk"),
        ("WPA3", "sae"),
        ("OWE", "owe"),
    ],
)
def test_key_management_follows_what_the_network_offers(security: str, management: str) -> None:
    assert choose_management(SeenNetwork("Lab", 50, (), security), with_password=True) == management


@pytest.mark.parametrize(("security", "said"), [("WPA2 802.1X", "user name"), ("WEP", "no protection")])
def test_network_that_cannot_be_joined_is_named(security: str, said: str) -> None:
    with pytest.raises(UserError) as caught:
        choose_management(SeenNetwork("Lab", 50, (), security), with_password=True)
    assert said in str(caught.value)


@pytest.mark.parametrize("password", ["1234567", "x" * 64, "a\nbcdefgh"])
def test_password_that_no_network_has_is_refused_without_being_shown(password: str) -> None:
    with pytest.raises(UserError) as caught:
        check_password("Lab", Secret(password))
    assert password not in str(caught.value)
    check_password("Lab", Secret("f" * 64))


@pytest.mark.parametrize(
    ("networks", "said", "help"),
    [
        (Networks(False, others=("dhcpcd",)), "managed by dhcpcd", "settings of dhcpcd"),
        (Networks(False), "something else", "network-manager"),
        (
            Networks(False, others=("dhcpcd",), supplicant=("/etc/wpa_supplicant/wpa_supplicant.conf",)),
            "dhcpcd with /etc/wpa_supplicant/wpa_supplicant.conf",
            "wpa_cli reconfigure",
        ),
        (Networks(True, others=("systemd-networkd",)), "eth0 is managed by systemd-networkd", "systemd-networkd"),
    ],
)
def test_other_managers_are_named_with_what_to_do(networks: Networks, said: str, help: str) -> None:
    device = NetworkDevice("eth0", "ethernet", "unmanaged", owner="") if networks.running else None
    with pytest.raises(UserError) as caught:
        check_managed(networks, "ros@bob.local", device)
    (problem,) = caught.value.diagnostics
    assert said in problem.message
    assert "nothing was changed" in problem.message
    assert help in (problem.help or "")


def test_profile_is_found_by_the_name_of_its_network_first() -> None:
    other = Profile("u-x", "802-11-wireless", "", "Home", "Elsewhere")
    assert find_profile(Networks(True, profiles=(other, HOME)), "Home") is HOME
    assert find_profile(Networks(True, profiles=(other,)), "Home") is other
    assert find_profile(NETWORKS, "wired") is None
