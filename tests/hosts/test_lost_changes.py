"""Changes of name and network with the link cut, the viewer killed, the power lost: the robot comes back by itself."""

import os
import random
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

import pytest
from tests.hosts.bench import UR, Bench, Machine, wait_until
from tests.hosts.managed import (
    PASSWORD,
    PENDING,
    SNAPSHOT,
    find_command,
    has_other_leader,
    managed_pair,
    wait_reached,
    wait_settled,
    wait_up,
)

pytestmark = [pytest.mark.timeout(1800)]
SEED = 20
WAIT = 6
RENAME = f"{UR} robot rename bob eve --password-from 0 --wait {WAIT}"
NETWORK = f"{UR} robot network bob --address 10.77.0.99/24 --password-from 0 --wait {WAIT}"


@dataclass(frozen=True)
class Blow:
    """What happens to a change, and when: while the robot is `told`, when it has `begun`, once all is `made`."""

    change: str
    moment: str
    cut: bool = False
    kill: bool = False
    power: bool = False
    given: Sequence[str] = ()

    def __str__(self) -> str:
        parts = ["link cut"] * self.cut + ["viewer killed"] * self.kill + ["power lost"] * self.power
        return f"{self.change.split(' robot ')[1].split(' --p')[0]}, {' and '.join(parts)} when {self.moment}"


MOMENTS = {
    "told": PENDING.replace("pending", "guard"),
    "begun": f"{PENDING}/begun",
    "made": f"{PENDING}/applied",
}
BLOWS = tuple(
    blow
    for change in (RENAME, NETWORK)
    for blow in (
        Blow(change, "told", cut=True),
        Blow(change, "begun", cut=True),
        Blow(change, "made", cut=True, kill=True),
        Blow(change, "made", kill=True),
        Blow(change, "made", cut=True, power=True),
    )
)


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    with managed_pair() as bench:
        yield bench


def test_robot_comes_back_by_itself_ten_times_of_ten(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    dice = random.Random(SEED)
    blows = list(BLOWS)
    dice.shuffle(blows)
    assert len(blows) == 10
    before = look(pair)
    for number, blow in enumerate(blows, start=1):
        said = strike(pair, blow)
        wait_up(robot)
        wait_settled(robot)
        robot.restore()
        wait_reached(laptop, "bob", robot.address)
        assert look(pair) == before, blow
        told = said()
        assert "Traceback" not in told, told
        if not blow.kill:
            assert "nothing" in told, told  # is lost, or has changed
        sys.stdout.write(f"{number} of {len(blows)}: {blow}: it came back\n")
    laptop.wait_for(f"{UR} doctor bob", user="pat", deadline=120)
    sys.stdout.write("10 of 10\n")


def look(pair: Bench) -> list[str]:
    """All that must be as before: files there, what is remembered here, name and addresses."""
    robot, laptop = pair["robot"], pair["laptop"]
    return [
        robot.run(SNAPSHOT).check().out,
        robot.run("cat /proc/sys/kernel/hostname; ip -brief -4 address show host0 | awk '{print $3}'").check().out,
        laptop.run("cat .ssh/known_hosts .config/ubiquity_launches/robots/*", user="pat").check().out,
    ]


def strike(pair: Bench, blow: Blow) -> Callable[[], str]:
    """Begin a change and let the blow fall; gives what waits for the end of the command and tells what it said."""
    laptop, robot = pair["laptop"], pair["robot"]
    process = laptop.spawn(
        # A shell in between: runuser and nsenter would stop with what they started, and stay so.
        f"{blow.change} <&0 & wait",
        user="pat",
        stdin=subprocess.PIPE,
    )
    assert process.stdin
    assert process.stdout
    process.stdin.write("".join(f"{password}\n" for password in (*blow.given, PASSWORD)))
    process.stdin.close()
    number = find_command(laptop, blow.change)
    wait_until(lambda: exists(robot, MOMENTS["told"]), f"{blow}", 60)
    os.kill(number, signal.SIGSTOP)  # so that it cannot confirm before the blow falls
    wait_until(lambda: exists(robot, MOMENTS[blow.moment]), f"{blow}", 60)
    if blow.cut:
        robot.cut()
    os.kill(number, signal.SIGKILL if blow.kill else signal.SIGCONT)
    if blow.power:
        leader = robot.leader
        with suppress(subprocess.TimeoutExpired):
            robot.run("reboot -ff", timeout=10)
        wait_until(lambda: has_other_leader(robot, leader), f"{robot.name} starts again", 60)

    def end() -> str:
        with process.stdout as stream:  # type: ignore[union-attr]  # it is a pipe
            text = stream.read()
        process.wait(60)
        return text

    return end


def exists(robot: Machine, path: str) -> bool:
    return (robot.root / path.lstrip("/")).exists()
