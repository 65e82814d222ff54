"""`ur robot wifi` and `ur robot network` with a real NetworkManager; only the wireless device is pretended."""

from collections.abc import Iterator

import pytest
from tests.hosts.bench import UR, Bench, Done, Machine, wait_until
from tests.hosts.managed import (
    PASSWORD,
    SNAPSHOT,
    has_other_leader,
    managed_pair,
    wait_reached,
    wait_settled,
    wait_up,
)
from tests.hosts.watch import Watcher, find_written

WIFI_PASSWORD = "wifi-secret-8128"
# No kernel of a bench has a wireless device: this stands before nmcli, adds one, and lets it join unless /root/refuse
# is there. Profiles go to the real NetworkManager.
PRETENDER = """\
#!/bin/sh
case "$*" in
*"device status"*) echo "wlan0:wifi:disconnected:";;
*"device wifi list"*) printf '%s\\n' ' :81:5180 MHz:WPA2:Lab' ' :70:2437 MHz:WPA2:Lab' ' :40:2412 MHz::Guests'; exit;;
*"ifname wlan0"*) [ -e /root/refuse ] || exit 0; echo "Error: Secrets were required, but not provided." >&2; exit 4;;
esac
exec /usr/bin/nmcli "$@"
"""


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    with managed_pair() as bench:
        bench["robot"].write("/usr/local/bin/nmcli", PRETENDER, mode=0o755)
        yield bench


def ur(laptop: Machine, words: str, *passwords: str) -> Done:
    option = "--passwords-from" if words.startswith("wifi") else "--password-from"
    given = "".join(f"{password}\n" for password in (*passwords, PASSWORD))
    return laptop.run(f"{UR} robot {words} {option} 0", user="pat", stdin=given, timeout=300)


def test_robot_gets_another_address_and_keeps_it_over_a_reboot(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    assert "10.77.0.11/24" in ur(laptop, "network bob").check().out
    done = ur(laptop, "network bob --address 10.77.0.99/24").check()
    assert "ros@10.77.0.99: answers, confirmed" in done.out
    wait_settled(robot)
    wait_reached(laptop, "bob", "10.77.0.99")
    laptop.wait_for(f"{UR} doctor bob", user="pat", deadline=60)
    leader = robot.leader
    robot.run("systemctl reboot")
    wait_until(lambda: has_other_leader(robot, leader), "the robot starts again", 60)
    wait_up(robot)
    wait_reached(laptop, "bob", "10.77.0.99")
    ur(laptop, "network bob --address 10.77.0.11/24").check()
    wait_reached(laptop, "bob", "10.77.0.11")


def test_address_that_this_computer_does_not_reach_is_taken_back(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    before = robot.run(SNAPSHOT).check().out
    done = ur(laptop, "network bob --address 10.88.0.99/24 --wait 5")
    assert done.code == 2
    assert "the robot reverted the change: it was not confirmed within 5 s" in done.err
    assert robot.run(SNAPSHOT).check().out == before
    wait_settled(robot)


def test_networks_in_reach_are_listed(pair: Bench) -> None:
    said = ur(pair["laptop"], "wifi bob", "").check().out
    assert "wlan0 uses no network" in said
    assert "2.4 GHz, 5 GHz" in said
    assert said.index("Lab") < said.index("Guests")


def test_joined_network_has_a_profile_and_its_password_is_nowhere_else(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    with Watcher((WIFI_PASSWORD, PASSWORD)) as watcher:
        ur(laptop, "wifi bob --ssid Lab", WIFI_PASSWORD).check()
        wait_settled(robot)
    assert watcher.looked > 0
    assert watcher.seen == set()
    stored = robot.run("nmcli -s -g 802-11-wireless-security.psk connection show Lab").check().out
    assert stored == f"{WIFI_PASSWORD}\n"
    assert robot.run("stat -c '%a %U' /etc/NetworkManager/system-connections/ur-*").check().out == "600 root\n"
    found = [path for path in find_written(robot, (WIFI_PASSWORD,)) if "/system-connections/ur-" not in path]
    assert found == []
    assert find_written(laptop, (WIFI_PASSWORD,)) == []
    assert "wired" in robot.run("nmcli -g NAME connection show").check().out  # what it knew before stays

    forgotten = ur(laptop, "wifi bob --forget Lab", "").check()
    assert "forget Lab: done" in forgotten.out
    assert "Lab" not in robot.run("nmcli -g NAME connection show").check().out
    assert find_written(robot, (WIFI_PASSWORD,)) == []


def test_network_that_refuses_the_password_leaves_the_robot_as_it_was(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    before = robot.run(SNAPSHOT).check().out
    robot.run("touch /root/refuse").check()
    done = ur(laptop, "wifi bob --ssid Lab", "wrong-secret")
    robot.run("rm /root/refuse").check()
    assert done.code == 2
    assert "join Lab: the robot reverted the change: Error: Secrets were required, but not provided." in done.err
    wait_settled(robot)
    assert robot.run(SNAPSHOT).check().out == before
    assert find_written(robot, ("wrong-secret",)) == []


@pytest.mark.parametrize(
    ("words", "password", "said"),
    [
        ("wifi bob --ssid Labb", WIFI_PASSWORD, "did you mean 'Lab'?"),
        ("wifi bob --ssid Lab", "short", "expected 8 to 63"),
        ("wifi bob --ssid Lab", "", "it requires a password, and none was given"),
        ("wifi bob --forget Lab", "", "the robot has no network with this name"),
        ("network bob --address 10.77.0.99", "", "is not a host address with a prefix length"),
        ("network bob --dhcp --device eth7", "", "no network device 'eth7'"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line_and_changes_nothing(
    pair: Bench, words: str, password: str, said: str
) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    before = robot.run(SNAPSHOT).check().out
    done = ur(laptop, words, *([password] if words.startswith("wifi") else []))
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err
    assert robot.run(SNAPSHOT).check().out == before
    wait_settled(robot)
