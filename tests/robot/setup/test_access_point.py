"""The robot's own access point: when it opens and closes, what is installed, and who knows its password."""

import shlex
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from ur.robot.setup import access_point_side as side
from ur.robot.setup.access_point import (
    MANAGER,
    NETPLAN,
    NETWORKD,
    OFF,
    PASSWORD,
    PATH,
    PROGRAM,
    RADIO,
    WantedAccessPoint,
    want_access_point,
)
from ur.robot.setup.facts import ABSENT, ComputerFacts, FileState, ServiceState
from ur.robot.setup.packages import WantedPackages
from ur.source.diagnostic import UserError

FOLDER, RUNS = FileState("", folder=True), ServiceState("active", "enabled")
FACTS = ComputerFacts(
    "ros",
    "/home/ros",
    "bob",
    "debian bookworm",
    "1",
    frozenset(),
    files={PASSWORD: ABSENT, RADIO: FOLDER, NETPLAN: FOLDER, PATH: ABSENT, PROGRAM: ABSENT},
    services={MANAGER: RUNS, NETWORKD: ServiceState()},
)
SERVER = replace(FACTS, services={MANAGER: ServiceState(), NETWORKD: RUNS})


def know(facts: ComputerFacts, text: str) -> ComputerFacts:
    return replace(facts, files={**facts.files, PASSWORD: FileState(text, 0o600)})


def run_policy(policy: side.Policy, *states: tuple[str, int]) -> list[tuple[int, str]]:
    """Ask once a second while each state lasts: o(nline), u(sed) or neither. Gives the seconds of its actions."""
    actions = []
    for now, state in enumerate(state for state, seconds in states for _ in range(seconds)):
        action = policy.decide(float(now), online=state == "o", used=state == "u")
        if action == "close":
            policy.close(float(now))
        actions += [(now, action)] if action else []
    return actions


def test_access_point_opens_after_three_minutes_without_a_network_and_no_earlier() -> None:
    assert run_policy(side.Policy(180.0), ("o", 100), ("", 170), ("o", 10), ("", 200)) == [(460, "open")]


def test_access_point_is_closed_for_half_a_minute_each_two_minutes_while_nobody_uses_it() -> None:
    assert run_policy(side.Policy(180.0), ("", 490)) == [
        (180, "open"),
        (300, "close"),
        (330, "open"),
        (450, "close"),
        (480, "open"),
    ]


def test_access_point_that_is_used_stays_open_until_two_minutes_later() -> None:
    assert run_policy(side.Policy(180.0), ("", 200), ("u", 1000), ("", 200))[:2] == [(180, "open"), (1319, "close")]


def test_network_that_is_found_while_looking_is_kept() -> None:
    assert run_policy(side.Policy(180.0), ("", 310), ("o", 1000)) == [(180, "open"), (300, "close")]


@pytest.fixture
def say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, dict[str, str]], None]:
    """Put programs in the place of all others that print a text for their arguments, and fail for other arguments."""
    monkeypatch.setenv("PATH", str(tmp_path))

    def make(name: str, texts: dict[str, str]) -> None:
        rows = "".join(f"{shlex.quote(words)}) echo {shlex.quote(text)};;\n" for words, text in texts.items())
        (tmp_path / name).write_text(f'#!/bin/sh\ncase "$*" in\n{rows}*) exit 1;; esac\n')
        (tmp_path / name).chmod(0o755)

    return make


ROUTE = {"-4 route show default": "default via 192.168.1.1 dev eth0 proto dhcp"}
CARRIER = {"link show dev wlan0": "3: wlan0: <BROADCAST,MULTICAST,UP,LOWER_UP> mtu 1500 state UP"}
ADDRESS = {"-o address show dev wlan0 scope global": "3: wlan0    inet 192.168.1.7/24 scope global wlan0"}


@pytest.mark.parametrize(
    ("texts", "online"),
    [
        ({**CARRIER, **ADDRESS}, True),
        (ROUTE, True),
        ({"-4 route show default": "default via 192.168.1.1 dev eth0 linkdown"}, False),
        (CARRIER, False),
        (ADDRESS, False),
    ],
)
def test_robot_has_a_network_with_a_router_or_with_an_address_on_a_joined_radio(
    say: Callable[[str, dict[str, str]], None], texts: dict[str, str], online: bool
) -> None:
    say("ip", texts)
    assert side.is_online("wlan0") is online


@pytest.mark.parametrize(
    ("devices", "kind"),
    [
        ("eth0:ethernet:connected\nwlan0:wifi:disconnected", side.NetworkManager),
        ("wlan0:wifi:unavailable", type(None)),
        ("eth0:ethernet:connected", side.Networkd),
        ("wlan0:wifi:unmanaged", side.Networkd),
    ],
)
def test_device_is_served_by_who_manages_it(
    say: Callable[[str, dict[str, str]], None], devices: str, kind: type
) -> None:
    say("nmcli", {"-t -f DEVICE,TYPE,STATE device status": devices})
    say("networkctl", {"--no-legend --no-pager list": "1 lo loopback carrier unmanaged\n2 wlan0 wlan off configured"})
    for name in ("netplan", "hostapd"):
        say(name, {})
    found = side.find_radio()
    assert isinstance(found, kind)
    assert getattr(found, "device", "wlan0") == "wlan0"


def test_set_up_installs_what_the_manager_of_the_networks_lacks() -> None:
    for facts, names in ((FACTS, ("dnsmasq-base",)), (SERVER, ("hostapd",))):
        first = want_access_point(facts, None)[0]
        assert isinstance(first, WantedPackages)
        assert first.names == names


def test_robot_without_a_radio_or_a_known_manager_gets_none_and_refuses_the_option() -> None:
    wired = replace(FACTS, files={**FACTS.files, RADIO: ABSENT})
    unmanaged = replace(FACTS, services={MANAGER: ServiceState(), NETWORKD: ServiceState()})
    for facts in (wired, unmanaged):
        assert want_access_point(facts, None) == []
        with pytest.raises(UserError, match="cannot have an access point"):
            want_access_point(facts, True)


def test_password_is_made_once_on_the_robot_and_shown_in_no_change() -> None:
    wanted = WantedAccessPoint("access point", on=True)
    change = wanted.plan(FACTS)
    assert change
    assert "umask 077" in change.commands[0].script
    assert wanted.plan(know(FACTS, "abcd-efgh-jkmn\n")) is None
    off = WantedAccessPoint("no access point", on=False).plan(know(FACTS, "abcd-efgh-jkmn\n"))
    assert off
    assert "abcd" not in repr(off)


def test_decision_against_it_is_kept_until_it_is_chosen_again() -> None:
    off = know(FACTS, f"{OFF}\n")
    (kept,) = want_access_point(off, None)
    assert kept.plan(off) is None
    assert any(item.title == "access point" and item.plan(off) for item in want_access_point(off, True))
    undone = WantedAccessPoint("access point", on=True).undo(off)
    assert undone
    assert PROGRAM in undone.commands[0].script
