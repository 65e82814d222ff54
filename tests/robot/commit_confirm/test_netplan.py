"""Changes of netplan's files: on trial in /run, for good in /etc, and the plans that order them."""

import base64
import json
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from ur.robot.commit_confirm.choice import choose_manager
from ur.robot.commit_confirm.guarded import list_changes
from ur.robot.commit_confirm.netplan import Netplan
from ur.robot.commit_confirm.netplan_side import load, names, run
from ur.robot.commit_confirm.network import NetworkManager, WirelessNetwork, parse_addressing
from ur.robot.commit_confirm.network_facts import NETPLAN, NetworkDevice, Networks, Profile
from ur.robot.setup.facts import ComputerFacts
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError

FACTS = ComputerFacts("ros", "/home/ros", "bob", "", "1", frozenset())
WLAN = NetworkDevice("wlan0", "wifi", "routable (configured)", "Home", ("192.168.1.7/24",), NETPLAN)
ETHERNET = NetworkDevice("eth0", "ethernet", "routable (configured)", owner=NETPLAN)
HOME = Profile("Home", "802-11-wireless", "wlan0", "Home", "Home")
NETPLANNED = Netplan(Networks(False, (WLAN, ETHERNET), (HOME,)))
CLOUD = """\
network:
  version: 2
  wifis:
    wlan0: {dhcp4: true, regulatory-domain: DE, access-points: {Home: {password: 01234567}, "No": {}}}
"""
POINT = {"device": "wlan0", "ssid": "Lab", "shown": "IkxhYiI=", "point": {"password": "08 secret"}}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A robot's disk with cloud-init's file."""
    (tmp_path / "etc/netplan").mkdir(parents=True)
    (tmp_path / "run/netplan").mkdir(parents=True)
    (tmp_path / "etc/netplan/50-cloud-init.yaml").write_text(CLOUD)
    return tmp_path


def read(path: Path) -> Any:
    return yaml.load(path.read_text(), Loader=yaml.BaseLoader)


def order(change: Any) -> Any:
    (planned,) = list_changes(change, FACTS)
    (command,) = planned.commands
    assert isinstance(command.stdin, Secret)
    return json.loads(command.stdin.reveal())


def test_change_on_trial_touches_nothing_that_a_power_cut_keeps(root: Path) -> None:
    run(root, POINT, "/run")
    trial = root / "run/netplan/90-ur.yaml"
    assert trial.stat().st_mode & 0o777 == 0o600
    assert read(trial)["network"]["wifis"] == {"wlan0": {"access-points": {"Lab": {"password": "08 secret"}}}}
    assert [path.name for path in (root / "etc").rglob("*") if path.is_file()] == ["50-cloud-init.yaml"]
    assert names(load(root, trial=True)) == {"wlan0": ["Home", "No", "Lab"]}
    assert names(load(root, trial=False)) == {"wlan0": ["Home", "No"]}


def test_confirmed_change_is_in_etc_alone_and_a_second_time_is_the_same(root: Path) -> None:
    run(root, POINT, "/run")
    for _ in range(2):  # a power cut may come between what is written and what is recorded
        run(root, POINT, "/etc")
    ours = root / "etc/netplan/90-ur.yaml"
    assert ours.stat().st_mode & 0o777 == 0o600
    assert "Lab" in read(ours)["network"]["wifis"]["wlan0"]["access-points"]
    assert [path.name for path in (root / "run").rglob("*") if path.is_file()] == []
    assert (root / "etc/netplan/50-cloud-init.yaml").read_text() == CLOUD
    unit = (root / "etc/systemd/system/netplan-wpa-wlan0.service.d/90-ur.conf").read_text()
    assert "IkxhYiI=" in unit
    assert "secret" not in unit


def test_first_network_of_a_device_gets_an_address_by_dhcp(root: Path) -> None:
    (root / "etc/netplan/50-cloud-init.yaml").write_text("network: {version: 2}\n")
    run(root, POINT, "/etc")
    assert read(root / "etc/netplan/90-ur.yaml")["network"]["wifis"]["wlan0"]["dhcp4"] == "true"


def test_forgotten_network_is_gone_from_every_file_and_other_values_stay_as_written(root: Path) -> None:
    run(root, POINT, "/etc")
    for ssid in ("Lab", "No"):
        run(root, {"device": "wlan0", "forget": ssid}, "/run")
        assert ssid not in names(load(root, trial=True))["wlan0"]
        run(root, {"device": "wlan0", "forget": ssid}, "/etc")
    left = read(root / "etc/netplan/50-cloud-init.yaml")["network"]["wifis"]["wlan0"]
    assert left["access-points"] == {"Home": {"password": "01234567"}}
    assert left["regulatory-domain"] == "DE"
    assert "secret" not in (root / "etc/netplan/90-ur.yaml").read_text()
    run(root, {"device": "wlan0", "forget": "Home"}, "/etc")
    assert all("wifis" not in (each or {}).get("network", {}) for each in load(root, trial=True).values())


def test_address_is_a_definition_of_its_own_that_networkd_prefers(root: Path) -> None:
    wanted = parse_addressing("10.0.0.7/24", "10.0.0.1", ("1.1.1.1",), dhcp=False)
    run(root, order(NETPLANNED.address(ETHERNET, wanted)), "/etc")
    assert read(root / "etc/netplan/90-ur.yaml")["network"]["ethernets"] == {
        "00-ur-eth0": {
            "match": {"name": "eth0"},
            "optional": "true",
            "nameservers": {"addresses": ["1.1.1.1"]},
            "dhcp4": "false",
            "addresses": ["10.0.0.7/24"],
            "routes": [{"to": "0.0.0.0/0", "via": "10.0.0.1", "metric": "100"}],
        }
    }
    dhcp = order(NETPLANNED.address(WLAN, parse_addressing(None, None, (), dhcp=True)))
    assert dhcp["address"] == {"optional": "true", "dhcp4": "true", "dhcp4-overrides": {"route-metric": "600"}}


def test_password_is_on_standard_input_and_nowhere_else() -> None:
    change = NETPLANNED.join(WirelessNetwork("Lab", Secret("pass word"), "sae", hidden=True, band="5"), WLAN)
    assert order(change)["point"] == {
        "auth": {"key-management": "sae", "password": "pass word"},
        "hidden": "true",
        "band": "5GHz",
    }
    (planned,) = list_changes(change, FACTS)
    assert "pass word" not in repr((planned, change)) + planned.commands[0].script + change.live + change.commit


def test_known_network_keeps_its_settings_and_is_preferred() -> None:
    assert order(NETPLANNED.join(WirelessNetwork("Home", None, ""), WLAN))["point"] is None
    assert order(NETPLANNED.join(WirelessNetwork("Cafe", None, ""), WLAN))["point"] == {}


@pytest.mark.parametrize(("ssid", "printed"), [("Lab", '"Lab"'), ('a "b" $x', '"a "b" $x"'), ("Läb", "4cc3a462")])
def test_network_is_compared_as_wpa_cli_prints_it(ssid: str, printed: str) -> None:
    shown = order(NETPLANNED.join(WirelessNetwork(ssid, None, ""), WLAN))["shown"]
    assert base64.b64decode(shown).decode() == printed


@pytest.mark.parametrize(
    ("ssid", "management", "said"), [("a\nb", "", "takes no such name"), ("Lab", "owe", "unknown to netplan")]
)
def test_network_that_netplan_cannot_hold_is_refused(ssid: str, management: str, said: str) -> None:
    with pytest.raises(UserError, match=said):
        NETPLANNED.join(WirelessNetwork(ssid, None, management), WLAN)


def test_address_of_another_kind_of_device_is_refused() -> None:
    bridge = NetworkDevice("br0", "bridge", "routable (configured)", owner=NETPLAN)
    with pytest.raises(UserError, match="br0 is a bridge"):
        NETPLANNED.address(bridge, parse_addressing(None, None, (), dhcp=True))


def test_device_is_changed_by_the_service_that_manages_it() -> None:
    networks = Networks(True, (WLAN, NetworkDevice("eth0", "ethernet", "connected")))
    assert isinstance(choose_manager(networks, "bob", networks.devices[0]), Netplan)
    assert isinstance(choose_manager(networks, "bob", networks.devices[1]), NetworkManager)


@pytest.mark.parametrize("plan", ["join", "address", "forget"])
def test_scripts_for_the_robot_are_valid(plan: str) -> None:
    changes = {
        "join": NETPLANNED.join(WirelessNetwork("it's", None, ""), WLAN),
        "address": NETPLANNED.address(ETHERNET, parse_addressing("10.0.0.7/24", None, (), dhcp=False)),
        "forget": NETPLANNED.forget(HOME),
    }
    for script in (changes[plan].live, changes[plan].back, changes[plan].commit):
        assert subprocess.run(["dash", "-n"], input=script, text=True, check=False).returncode == 0
