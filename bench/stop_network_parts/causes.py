"""The causes: what happens to a network while everybody drives. Each returns when nothing more happens."""

import struct
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.stop_network_parts.computer import Computer
from bench.stop_network_parts.lane import LEASED
from bench.stop_network_parts.network import Cause, Network

_OTHER_CLOCK = Path(__file__).resolve().parents[2] / "tests" / "hosts" / "other_clock.c"
_SET_CLOCK = "python3 -c \"open('/run/other-clock', 'r+b').write(bytes.fromhex('{value}'))\""
_PREPARE_CLOCK = """\
set -e
gcc -shared -fPIC -O1 -o /usr/local/lib/other_clock.so /root/other_clock.c
python3 -c "open('/run/other-clock', 'wb').write(bytes(8))"
chmod 666 /run/other-clock
echo /usr/local/lib/other_clock.so >/etc/ld.so.preload
"""
_HOUR = 3600 * 10**9  # ns
_FILL = "head -c 100M /dev/zero >{folder}/full; test -s {folder}/full"


@dataclass(frozen=True, slots=True)
class Lengths:
    """The longest durations of a cut and of a suspension, and the total duration of losses: s."""

    cut: float = 30.0
    suspend: float = 20.0
    loss: float = 30.0


def _cut_restore(network: Network, lengths: Lengths) -> None:
    _cut(network, _draw(network, 0.5, lengths.cut))


def _cut_kill_restore(network: Network, lengths: Lengths) -> None:
    seconds = _draw(network, 1.0, lengths.cut)
    network.laptop.machine.cut()
    killed_after = seconds * network.chance.uniform(0.1, 0.9)
    time.sleep(killed_after)
    network.laptop.kill_everything()
    time.sleep(seconds - killed_after)
    _restore(network)


def _cut_reboot(network: Network, lengths: Lengths) -> None:
    machine, leader = network.laptop.machine, network.laptop.machine.leader
    machine.cut()
    time.sleep(_draw(network, 0.5, lengths.cut / 2.0))
    machine.run("reboot" if network.chance.random() < 0.5 else "reboot -f -f")
    machine.wait_rebooted(leader)  # on a network that works
    network.back_at = time.monotonic()
    time.sleep(2.0)


def _suspend(network: Network, lengths: Lengths) -> None:
    cut = network.chance.random() < 0.5  # wireless adapters sleep, too; a docking station's do not
    if cut:
        network.laptop.machine.cut()
    network.laptop.suspend()
    time.sleep(_draw(network, 1.0, lengths.suspend))
    if cut:
        _restore(network)
    network.laptop.resume()
    network.back_at = time.monotonic()
    time.sleep(3.0)


def _loss(network: Network, lengths: Lengths) -> None:
    end = time.monotonic() + lengths.loss
    while time.monotonic() < end:
        network.laptop.machine.cut()
        time.sleep(network.chance.uniform(0.2, 5.0))
        _restore(network)
        time.sleep(network.chance.uniform(0.2, 3.0))


def _kill_teleop(network: Network, _lengths: Lengths) -> None:
    for lane in network.lanes:
        time.sleep(network.chance.uniform(0.0, 0.2))
        network.laptop.order("kill", name=lane.name)


def _kill_master(network: Network, lengths: Lengths) -> None:
    network.robot.order("kill", name="master")
    time.sleep(network.chance.uniform(0.5, 1.5))
    _cut(network, _draw(network, 0.5, lengths.cut / 2.0))
    time.sleep(1.0)
    _kill_teleop(network, lengths)


def _mount_small_disk(network: Network) -> None:
    folder = network.robot.ros_home
    network.robot.stop()
    network.robot.machine.run(f"mount -t tmpfs -o size=3m tmpfs {folder}").check()
    network.restart()


def _fill_disk(network: Network, lengths: Lengths) -> None:
    network.robot.machine.run(_FILL.format(folder=network.robot.ros_home))
    time.sleep(1.0)
    _cut_restore(network, lengths)
    time.sleep(1.0)
    _kill_teleop(network, lengths)


def _unmount_small_disk(network: Network) -> None:
    network.robot.stop()
    # A program that was killed a moment ago may still have a file open there.
    network.robot.machine.wait_for(f"umount {network.robot.ros_home}", deadline=20)
    network.restart()


def _prepare_clocks(network: Network) -> None:
    """Give both computers clocks of their own, from their next start on (see other_clock.c)."""
    for computer in (network.laptop, network.robot):
        if computer.machine.run("grep -q other_clock /etc/ld.so.preload && [ -s /run/other-clock ]").code:
            computer.machine.write("/root/other_clock.c", _OTHER_CLOCK.read_text())
            computer.machine.run(["bash", "-c", _PREPARE_CLOCK]).check()  # also after a reboot, which empties /run
            network.restart()


def _jump_laptop(network: Network, lengths: Lengths) -> None:
    _jump(network, network.laptop, lengths)


def _jump_robot(network: Network, lengths: Lengths) -> None:
    _jump(network, network.robot, lengths)


def _jump(network: Network, computer: Computer, lengths: Lengths) -> None:
    _set_clock(computer, network.chance.choice((-_HOUR, _HOUR)))
    time.sleep(1.0)
    _cut_restore(network, lengths)
    time.sleep(1.0)
    _set_clock(computer, 0)
    time.sleep(1.0)
    _kill_teleop(network, lengths)


def _set_clock(computer: Computer, difference: int) -> None:
    computer.machine.run(_SET_CLOCK.format(value=struct.pack("q", difference).hex())).check()


def _take_over(network: Network, lengths: Lengths) -> None:
    """Have a second laptop take over and drive the other way, then end by turns: properly, killed, or cut off."""
    second = network.get_second()
    second.start()
    for lane in network.lanes:
        if lane.commander in LEASED:
            client = second.order("commander", lane=asdict(lane), more={"UR_CLIENT_NAME": second.machine.name})
            network.second_clients.add(client)
    second.order("drive", pattern="held back")
    time.sleep(network.chance.uniform(3.0, 5.0))
    ending = network.chance.choice(("released", "killed", "cut"))
    if ending == "cut":
        second.machine.cut()
        time.sleep(min(5.0, lengths.cut))
    if ending == "released":
        second.order("drive", pattern="")
    else:
        second.kill_everything()
    time.sleep(0.5)
    second.machine.restore()
    time.sleep(3.0)


def _end_second(network: Network) -> None:
    network.get_second().stop()
    network.start_laptop()


def _cut(network: Network, seconds: float) -> None:
    network.laptop.machine.cut()
    time.sleep(seconds)
    _restore(network)


def _restore(network: Network) -> None:
    network.laptop.machine.restore()
    network.back_at = time.monotonic()


def _draw(network: Network, shortest: float, longest: float) -> float:
    """A duration; short ones are as likely as long ones."""
    return float(min(shortest, longest) * max(1.0, longest / shortest) ** network.chance.random())


CAUSES: Mapping[str, Cause] = {
    "cut": Cause("cut and restored", _cut_restore),
    "kill": Cause("cut, all killed, restored", _cut_kill_restore, lost=True),
    "reboot": Cause("cut, laptop rebooted", _cut_reboot, lost=True),
    "suspend": Cause("laptop suspended, resumed", _suspend),
    "loss": Cause("bursts of loss", _loss),
    "teleop": Cause("teleop killed", _kill_teleop, lost=True),
    "master": Cause("robot's master killed", _kill_master, lost=True, after=Network.restart),
    "second": Cause("second laptop takes over", _take_over, after=_end_second, commanders=LEASED, pattern="held"),
    "disk": Cause("robot's disk full", _fill_disk, lost=True, before=_mount_small_disk, after=_unmount_small_disk),
    "clock": Cause("laptop's clock off by 1 h", _jump_laptop, lost=True, before=_prepare_clocks),
    "robot-clock": Cause("robot's clock off by 1 h", _jump_robot, lost=True, before=_prepare_clocks),
}
