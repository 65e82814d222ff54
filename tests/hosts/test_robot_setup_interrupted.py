"""`ur robot setup` interrupted at each of its points: the robot can be reached, and going on leads to the same end."""

import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

import pytest
from tests.hosts.bench import Bench, Machine, boot, wait_until
from tests.hosts.test_robot_setup import PASSWORD, command, prepare, set_up

# All that a set-up of a freshly flashed robot says before it does it.
POINTS = (
    *("ssh folder", "login from the viewer", "robot file", "packages", "announcement", "X11 over ssh"),
    *("time from the viewer", "groups", "ROS environment", "bash reads it", "login shells read it", "zsh reads it"),
    *("catkin workspace", "ssh key", "login to itself", "its own host key", "host key of the viewer"),
    *("ROS master at boot", "ROS master", "password", "cloud-init", "host name (hosts)", "host name"),
    *("here: host key of NAME", "here: login from NAME", "here: memory of it"),
    *("reboot as NAME.local", "waiting for NAME.local"),
)
NAMES = {"robot": "bob", "robot2": "eve"}


@pytest.fixture
def three() -> Iterator[Bench]:
    """A laptop that was set up, and two robots that were just flashed."""
    with boot(("laptop", "robot", "robot2")) as bench:
        prepare(bench["laptop"])
        yield bench


def run_until(
    laptop: Machine, line: str, stdin: str, strikes: Mapping[str, Callable[[int], None]]
) -> tuple[list[str], int]:
    """Run it; whenever it says one of the keys, call that with the number of its process. All it said, and its code."""
    process = laptop.spawn(f"echo $$; exec {line}", user="pat", stdin=subprocess.PIPE)
    assert process.stdin
    assert process.stdout
    process.stdin.write(stdin)
    process.stdin.close()
    number = int(process.stdout.readline())
    said = []
    with process.stdout:
        for text in process.stdout:
            said.append(text.strip())
            strike = strikes.get(text.strip())
            if strike:
                strike(number)
    return said, process.wait(60)


def interrupt_everywhere(
    laptop: Machine, robot: Machine, points: Sequence[str], interrupt: Callable[[int], None]
) -> int:
    """Interrupt a set-up at each point once, going on each time; then let it finish. How often it was interrupted."""
    name = NAMES[robot.name]
    struck = 0
    for point in points:
        line = f"{name}: {point.replace('NAME', name)}"
        strikes = {f"{name}: waiting for {name}.local": lambda _: restore(robot), line: interrupt}
        said, code = run_until(laptop, command(f"{robot.name}.local", name), f"ros\n{PASSWORD}\n", strikes)
        assert "Traceback" not in "".join(said)
        if line in said:
            struck += 1
            assert code in (0, 137) or "error:" in "".join(said), said  # done, killed, or told what is wrong
        sys.stdout.write(f"{robot.name}: {point}: {code}\n")  # where it was, should it fail
        robot.wait_booted()
        robot.restore()
        laptop.wait_for(f"timeout 5 ssh-keyscan -T 2 {robot.address} 2>/dev/null | grep -q ed25519", deadline=60)
        wait_until(lambda: not connections(laptop, robot.name, name), "connections to it end", 60)
    done = set_up(laptop, f"{robot.name}.local", name).check()
    assert "NO" not in done.out
    again = set_up(laptop, f"{name}.local", name, current="").check()
    assert "nothing to do" in again.out
    return struck


def restore(robot: Machine) -> None:
    with suppress(LookupError, subprocess.CalledProcessError):  # it reboots: that restores it, too
        robot.restore()


def connections(laptop: Machine, *hosts: str) -> list[str]:
    """The processes here that hold a connection to one of these hosts."""
    names = [f"@{host}.local" for host in hosts]
    return [line for _, line in laptop.processes() if line.startswith("ssh ") and any(name in line for name in names)]


def is_tidy(laptop: Machine) -> bool:
    """Whether no folder of an interrupted set-up is left."""
    return not laptop.run("ls -d /tmp/ur-* 2>/dev/null").out


def test_killed_at_every_point_a_next_run_goes_on_to_the_same_end(three: Bench) -> None:
    laptop, robot = three["laptop"], three["robot"]

    def kill(number: int) -> None:
        laptop.run(f"kill -KILL {number}")

    assert interrupt_everywhere(laptop, robot, POINTS, kill) >= 24
    wait_until(lambda: is_tidy(laptop), "folders of the killed ones go", 60)


@pytest.mark.timeout(1800)  # each cut has to be noticed
def test_cut_off_at_every_point_a_next_run_goes_on_to_the_same_end(three: Bench) -> None:
    laptop = three["laptop"]

    def try_half(half: int) -> int:
        robot = three[list(NAMES)[half]]

        def cut(_: int) -> None:
            with suppress(LookupError, subprocess.CalledProcessError):  # it reboots already: it is off the network
                robot.cut()

        return interrupt_everywhere(laptop, robot, POINTS[half::2], cut)

    with ThreadPoolExecutor(2) as pool:  # most of the time is spent noticing
        assert sum(pool.map(try_half, (0, 1))) >= 24
    wait_until(lambda: is_tidy(laptop), "folders of those that were cut off go", 60)
