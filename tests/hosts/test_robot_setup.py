"""`ur robot setup` from a freshly flashed robot to a ready one, and whatever may happen on the way."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from tests.hosts.bench import UR, Bench, Done, Machine, boot, wait_until

pytestmark = pytest.mark.long
PASSWORD = "new-secret-2718"
SUDO = "pat ALL=(ALL) NOPASSWD: ALL\n"


@pytest.fixture
def pair() -> Iterator[Bench]:
    """A laptop that was set up, and a robot that was just flashed."""
    with boot(("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        yield bench


def prepare(laptop: Machine) -> None:
    laptop.write("/etc/sudoers.d/pat", SUDO, mode=0o440)
    laptop.run(f"{UR} setup --yes", user="pat", timeout=300).check()


def command(host: str, name: str, *options: str) -> str:
    return f"{UR} robot setup {host} --name {name} --base magni --passwords-from 0 {' '.join(options)}"


def set_up(
    laptop: Machine, host: str = "robot.local", name: str = "bob", current: str = "ros", new: str = PASSWORD
) -> Done:
    return laptop.run(command(host, name), user="pat", stdin=f"{current}\n{new}\n", timeout=400)


@dataclass
class Watcher:
    """Looks for a text in the command lines and environments of all processes while it runs."""

    text: str
    seen: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._watch)

    def __enter__(self) -> Watcher:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._stop.is_set():
            for entry in Path("/proc").iterdir():
                if entry.name.isdigit():
                    for part in ("cmdline", "environ"):
                        try:
                            content = (entry / part).read_bytes()
                        except OSError:
                            continue
                        if self.text.encode() in content:
                            self.seen.add(content.decode(errors="replace"))


def test_fresh_robot_becomes_ready_and_a_second_run_changes_nothing(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    with Watcher(PASSWORD) as watcher:
        done = set_up(laptop).check()
    assert "NO" not in done.out
    assert "ready after" in done.out
    assert watcher.seen == set()
    for machine in (laptop, robot):
        # Everything that was written since the computers were made lies in the upper layer of its file system.
        upper = machine.root.parent / "upper"
        found = subprocess.run(["grep", "-rlaF", PASSWORD, str(upper)], capture_output=True, text=True, check=False)
        assert found.stdout == ""
    assert PASSWORD not in done.out + done.err + laptop.journal() + robot.journal()

    again = set_up(laptop, "bob.local", current="").check()
    assert "nothing to do" in again.out
    assert "bob: packages" not in again.out

    # The old password is gone, the new one is there, and sshd still refuses strangers.
    for word, good in (("ros", False), (PASSWORD, True)):
        assert (robot.run("su -c true ros", user="pat", stdin=f"{word}\n").code == 0) is good


def test_topics_arrive_both_ways_between_laptop_and_robot(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    set_up(laptop).check()
    laptop.run(f"{UR} use bob", user="pat").check()
    users = {"laptop": "pat", "robot": "ros"}
    with running(robot, "roscore", "ros"):
        robot.wait_for("rostopic list", user="ros")
        for speaker, listener in ((laptop, robot), (robot, laptop)):
            talk = f"rostopic pub -r 10 /from_{speaker.name} std_msgs/String 'data: hello from {speaker.name}'"
            with running(speaker, talk, users[speaker.name]):
                said = listener.wait_for(
                    f"timeout 10 rostopic echo -n 1 /from_{speaker.name}", user=users[listener.name]
                )
                assert f"hello from {speaker.name}" in said.out


def test_wrong_password_is_named_and_changes_nothing(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    done = set_up(laptop, current="not-it", new="")
    assert done.code == 2
    assert "the login was refused" in done.err
    assert "Traceback" not in done.err
    assert robot.read("/etc/hostname") == "robot\n"


def test_password_that_must_be_changed_first_is_named_and_changes_nothing(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    robot.run("chage -d 0 ros").check()
    done = set_up(laptop)
    assert done.code == 2
    assert "has to be changed at the first login" in done.err
    assert "ssh ros@robot.local" in done.err
    assert robot.read("/etc/hostname") == "robot\n"


def test_name_of_another_computer_is_refused(pair: Bench) -> None:
    done = set_up(pair["laptop"], name="laptop")
    assert done.code == 2
    assert "taken" in done.err


def test_robot_that_was_flashed_again_needs_consent(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    set_up(laptop, name="robot").check()
    robot.run("rm /etc/ssh/ssh_host_*; ssh-keygen -A; systemctl restart ssh").check()
    done = set_up(laptop, name="robot", current=PASSWORD)
    assert done.code == 2
    assert "--new-host-key" in done.err
    laptop.run(
        command("robot.local", "robot", "--new-host-key"), user="pat", stdin=f"{PASSWORD}\n\n", timeout=400
    ).check()
    set_up(laptop, name="robot").check()


def test_two_robots_are_set_up_at_once() -> None:
    with boot(("laptop", "robot", "robot2")) as bench:
        laptop = bench["laptop"]
        prepare(laptop)
        robots = "".join(
            f"- {{host: {old}.local, name: {new}, base: magni}}\n" for old, new in (("robot", "bob"), ("robot2", "eve"))
        )
        laptop.write("/home/pat/robots.yaml", f"robots:\n{robots}")
        line = f"{UR} robot setup --from robots.yaml --passwords-from 0"
        done = laptop.run(line, user="pat", stdin=f"ros\n{PASSWORD}\n", timeout=400).check()
        assert done.out.count("ready after") == 2
        seen = laptop.wait_for(f"{UR} robots", user="pat")
        assert seen.out.count("magni") == 2
        assert bench["robot"].address in seen.out
        said = laptop.run(f"{UR} shell eve cat /etc/hostname", user="pat").check()
        assert said.out == "eve\n"
        again = laptop.run(
            "sed -i 's/robot2.local/eve.local/; s/robot.local/bob.local/' robots.yaml;" + line,
            user="pat",
            stdin=f"{PASSWORD}\n\n",
        )
        assert again.out.count("nothing to do") == 2


class running:  # noqa: N801 - used as a function
    """A command that runs inside while the context lasts."""

    def __init__(self, machine: Machine, line: str, user: str) -> None:
        self.machine, self.line, self.user = machine, line, user

    def __enter__(self) -> None:
        self.process = subprocess.Popen(
            self.machine.command_line(f"exec {self.line}", user=self.user),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def __exit__(self, *_: object) -> None:
        self.process.terminate()
        wait_until(lambda: self.process.poll() is not None, self.line)


def run_until(laptop: Machine, line: str, stdin: str, point: str, strike: Callable[[int], None]) -> list[str]:
    """Run it, and as soon as it says the text `point`, strike its process (the number inside); all that it said."""
    process = subprocess.Popen(
        laptop.command_line(f"echo $$; exec {line}", user="pat"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert process.stdin
    assert process.stdout
    process.stdin.write(stdin)
    process.stdin.close()
    number = int(process.stdout.readline())
    said = []
    with process.stdout:
        for text in process.stdout:
            said.append(text.strip())
            if text.strip() == point:
                strike(number)
    process.wait(60)
    return said


POINTS = (
    *(
        "ssh folder",
        "login from the viewer",
        "robot file",
        "packages",
        "announcement",
        "X11 over ssh",
        "time from the viewer",
    ),
    *(
        "groups",
        "ROS environment",
        "bash reads it",
        "login shells read it",
        "zsh reads it",
        "catkin workspace",
        "ssh key",
    ),
    *("login to itself", "its own host key", "host key of the viewer", "password", "host name (hosts)", "host name"),
    *("here: host key of bob", "here: login from bob", "here: memory of it", "reboot as bob.local"),
)


def test_killed_at_every_point_a_next_run_goes_on_to_the_same_end(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]

    def kill(number: int) -> None:
        laptop.run(f"kill -KILL {number}; pkill -KILL -u pat ssh")

    interrupt_everywhere(laptop, robot, kill)


@pytest.mark.timeout(3600)  # each cut has to be noticed
def test_cut_off_at_every_point_a_next_run_goes_on_to_the_same_end(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]

    def cut(_: int) -> None:
        with suppress(LookupError, subprocess.CalledProcessError):  # it reboots already: it is off the network
            robot.cut()

    interrupt_everywhere(laptop, robot, cut)


def interrupt_everywhere(laptop: Machine, robot: Machine, strike: Callable[[int], None]) -> None:
    """Interrupt a set-up at each point once, going on each time; then let it finish."""
    struck = 0
    for point in POINTS:
        said = run_until(laptop, command("robot.local", "bob"), f"ros\n{PASSWORD}\n", f"bob: {point}", strike)
        struck += f"bob: {point}" in said
        assert "Traceback" not in "".join(said)
        robot.wait_booted()
        robot.restore()
        sys.stdout.write(f"{point}\n")  # where it was, should it fail
        laptop.wait_for(f"timeout 5 ssh-keyscan -T 2 {robot.address} 2>/dev/null | grep -q ed25519")
    assert struck >= 20
    done = set_up(laptop).check()
    assert "NO" not in done.out
    assert "nothing to do" in set_up(laptop, "bob.local", current="").check().out
