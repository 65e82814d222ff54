"""A robot of the bench whose network belongs to a real NetworkManager, and what is looked at around changes."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress

from tests.hosts.bench import Bench, Machine, boot, wait_until
from tests.hosts.test_robot_setup import PASSWORD, prepare, set_up

PROFILE_UUID = "6b3c0bd1-07ad-4d0f-a8f1-6ad8cd0e3c11"
PROFILE = f"""\
[connection]
id=wired
uuid={PROFILE_UUID}
type=ethernet
interface-name=host0

[ipv4]
method=manual
address1={{address}}/24

[ipv6]
method=link-local
"""
# Debian leaves the devices of containers alone.
SETTINGS = "[device]\nmatch-device=interface-name:host0\nmanaged=1\n"
TAKE_OVER = (
    "systemctl unmask NetworkManager && systemctl enable NetworkManager && "
    "systemctl mask systemd-networkd.socket systemd-networkd && "
    "systemctl stop systemd-networkd.socket systemd-networkd && systemctl restart NetworkManager"
)
PENDING = "/var/lib/ubiquity/change/pending"
LEFT = (
    "ls -d /var/lib/ubiquity/change/[!l]* /etc/systemd/system/ur-* /etc/systemd/system/*.wants/ur-* 2>/dev/null; "
    "systemctl list-units --plain --no-legend 'ur-change-*' | grep -v ' inactive '"
)
# All that a change touches: rights, owners and contents.
FILES = (
    "/etc/hostname /etc/hosts /etc/ubiquity /etc/avahi/services /etc/cloud/cloud.cfg.d /home/ros/.ssh "
    "/etc/NetworkManager /var/lib/NetworkManager/no-auto-default.state"
)
SNAPSHOT = f"find {FILES} -type f -printf '%m %u %g %p ' -exec sha256sum {{}} \\; 2>/dev/null | sort -k 4"


@contextmanager
def managed_pair() -> Iterator[Bench]:
    """A laptop, and a robot `bob` that was set up from it and whose network belongs to NetworkManager."""
    with boot(("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        set_up(bench["laptop"]).check()
        robot = bench["robot"]
        robot.write(
            "/etc/NetworkManager/system-connections/wired.nmconnection",
            PROFILE.format(address=robot.address),
            mode=0o600,
        )
        robot.write("/etc/NetworkManager/conf.d/bench.conf", SETTINGS)
        robot.run(TAKE_OVER).check()
        wait_up(robot)
        wait_reached(bench["laptop"], "bob")
        yield bench


def wait_up(robot: Machine) -> None:
    """Wait until what makes it reachable runs."""
    units = ("ssh", "avahi-daemon", "NetworkManager")
    active = " && ".join(f"systemctl is-active --quiet {unit}" for unit in units)
    robot.wait_for(f"{active} && nmcli -t -f STATE device status | grep -qx connected", deadline=60)


def wait_settled(robot: Machine) -> None:
    """Wait until no change is pending, and nothing of one is left."""
    robot.wait_for(f'[ -z "$({LEFT})" ]', deadline=120)


def wait_reached(laptop: Machine, name: str, address: str = "") -> None:
    """Wait until the laptop gets into the robot under this name, strictly, and finds it there."""
    options = "-o BatchMode=yes -o StrictHostKeyChecking=yes -o ConnectTimeout=10"
    login = f"ssh {options} ros@{name}.local cat /proc/sys/kernel/hostname"
    where = f"getent ahostsv4 {name}.local | grep -q '^{address} '" if address else "true"
    laptop.wait_for(f'[ "$({login})" = {name} ] && {where}', user="pat", deadline=60)


def has_other_leader(robot: Machine, leader: int) -> bool:
    """Whether it has started again after `leader` was its init."""
    with suppress(LookupError):
        return robot.leader != leader
    return False


def find_command(machine: Machine, line: str) -> int:
    """The number, as seen from here, of the process that runs this command line: for signals that are there at once."""
    found: list[int] = []

    def find() -> bool:
        found[:] = [number for number, words in machine.processes() if words.startswith(line)]
        return bool(found)

    wait_until(find, f"{machine.name}: {line} runs", 60)
    return found[0]


__all__ = [
    "PASSWORD",
    "PENDING",
    "PROFILE_UUID",
    "SETTINGS",
    "SNAPSHOT",
    "TAKE_OVER",
    "find_command",
    "has_other_leader",
    "managed_pair",
    "wait_reached",
    "wait_settled",
    "wait_up",
]
