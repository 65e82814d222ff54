"""The table of trials: each kind of a change of WiFi, the same with netplan and with NetworkManager."""

import sys
import time
from collections.abc import Iterator

import pytest
from tests.hosts.managed import wait_settled
from tests.hosts.test_lost_changes import Blow, strike
from tests.hosts.test_netplan import CELLAR, LAB, LAB_PASSWORD
from tests.hosts.test_wifi_change import ur
from tests.hosts.wireless import MANAGERS, Wireless, wireless_pair

pytestmark = [pytest.mark.timeout(3 * 3600)]
LOST = 120  # s after which a robot that no ssh reaches counts as lost
KINDS = ("changed", "refused", "wrong password", "cut", "power lost", "rebooted", "taken back")
BLOWS = {
    "cut": Blow(LAB[0], "begun", cut=True, kill=True, given=LAB[1:]),
    "power lost": Blow(LAB[0], "made", cut=True, power=True, given=LAB[1:]),
    "rebooted": Blow(LAB[0], "made", cut=True, given=LAB[1:]),
}


@pytest.fixture(scope="module", params=MANAGERS)
def pair(request: pytest.FixtureRequest) -> Iterator[Wireless]:
    with wireless_pair(request.param) as made:
        yield made


def change(pair: Wireless, kind: str) -> None:
    """Make a change, and let what its kind names happen to it."""
    laptop, robot = pair.laptop, pair.robot
    if kind == "changed":
        ur(laptop, "wifi bob --ssid Lab", LAB_PASSWORD).check()
        wait_settled(robot)
        pair.wait_uses("Lab")
        ur(laptop, "wifi bob --forget Lab", "").check()
    elif kind == "refused":
        assert "the robot sees no network of this name" in ur(laptop, "wifi bob --ssid Nowhere", LAB_PASSWORD).err
    elif kind == "wrong password":
        assert "the robot reverted the change" in ur(laptop, "wifi bob --ssid Lab", "wrong-secret").err
    elif kind == "taken back":
        assert "the robot reverted the change" in ur(laptop, "wifi bob --ssid Cellar --wait 6", CELLAR[1]).err
    else:
        said = strike(pair.bench, BLOWS[kind])
        if kind == "rebooted":
            leader = robot.leader
            robot.run("systemctl reboot --no-block")
            pair.wait_rebooted(leader)
        pair.wait_served()
        wait_settled(robot)
        robot.restore()
        text = said()
        assert "Traceback" not in text, text


def reach(pair: Wireless) -> None:
    """Log in by name, with the key that is known: what fails within LOST s is a lost robot."""
    login = "ssh -o BatchMode=yes -o StrictHostKeyChecking=yes -o ConnectTimeout=5 ros@bob.local hostname"
    pair.laptop.wait_for(f'[ "$({login})" = bob ]', user="pat", deadline=LOST)


@pytest.mark.parametrize("trials", [pytest.param(50, marks=pytest.mark.nightly)])
def test_no_robot_is_lost_by_a_change_of_its_wifi(pair: Wireless, trials: int) -> None:
    for number in range(trials):
        kind = KINDS[number % len(KINDS)]
        before = pair.look()
        change(pair, kind)
        end = time.monotonic()
        wait_settled(pair.robot)
        reach(pair)
        sys.stdout.write(f"{pair.manager}, {number + 1} of {trials}: {kind}: {time.monotonic() - end:.0f} s\n")
        sys.stdout.flush()
        pair.wait_uses("Home")
        if kind != "changed":
            assert pair.look() == before, kind
