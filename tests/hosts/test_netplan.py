"""Changes of name and network on robots with netplan, under NetworkManager and under systemd-networkd."""

from collections.abc import Iterator

import pytest
from tests.hosts.bench import Bench
from tests.hosts.managed import PROFILE_UUID, managed_pair, wait_reached, wait_settled, wait_up
from tests.hosts.test_lost_changes import NETWORK, Blow, strike

pytestmark = [pytest.mark.timeout(3600)]
INSTALL = "apt-get -qq update && apt-get -qqy --no-install-recommends install netplan.io wpasupplicant"
MANAGED = f"""\
network:
  version: 2
  ethernets:
    NM-{PROFILE_UUID}:
      renderer: NetworkManager
      match: {{name: host0}}
      networkmanager: {{uuid: {PROFILE_UUID}, name: wired}}
      addresses: [10.77.0.11/24]
"""
# NetworkManager of Ubuntu 24.04 and Raspberry Pi OS 13 writes its profiles to /etc/netplan; Debian's leaves them alone.
WRITER = """\
#!/bin/sh
case "$*" in "connection modify "*)
  sed -i "s|addresses: .*|addresses: [$7]|" /etc/netplan/90-NM-*.yaml && netplan generate
  exec /usr/bin/nmcli connection reload;;
esac
exec /usr/bin/nmcli "$@"
"""


@pytest.fixture(scope="module")
def managed() -> Iterator[Bench]:
    """A robot whose NetworkManager keeps its profiles in netplan."""
    with managed_pair() as bench:
        robot = bench["robot"]
        robot.run(INSTALL, timeout=300).check()
        robot.write(f"/etc/netplan/90-NM-{PROFILE_UUID}.yaml", MANAGED, mode=0o600)
        robot.write("/usr/local/bin/nmcli", WRITER, mode=0o755)
        robot.run("rm /etc/NetworkManager/system-connections/wired.nmconnection; netplan generate").check()
        robot.run("systemctl restart NetworkManager").check()
        wait_up(robot)
        yield bench


def test_power_cut_takes_an_address_back_that_netplan_has_stored_for_network_manager(managed: Bench) -> None:
    laptop, robot = managed["laptop"], managed["robot"]
    assert robot.address == "10.77.0.11"
    ended = strike(managed, Blow(NETWORK, "made", cut=True, power=True))
    wait_up(robot)
    wait_settled(robot)
    robot.restore()
    wait_reached(laptop, "bob", robot.address)
    assert "Traceback" not in ended()
