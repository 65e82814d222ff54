"""`ur robot setup` from a freshly flashed robot to a ready one, and whatever may happen on the way."""

import subprocess
from collections.abc import Iterator

import pytest
from tests.hosts.bench import UR, Bench, Done, Machine, boot, wait_until

PASSWORD = "new-secret-2718"
SUDO = "pat ALL=(ALL) NOPASSWD: ALL\n"


@pytest.fixture
def pair() -> Iterator[Bench]:
    """A laptop that was set up, and a robot that was just flashed."""
    with boot(("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        yield bench


@pytest.fixture(scope="module")
def untouched() -> Iterator[Bench]:
    """The same, for those who change nothing."""
    with boot(("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        yield bench


@pytest.fixture(scope="module")
def ready() -> Iterator[tuple[Bench, Done]]:
    """The robot set up, for those who change nothing of that; and what its set-up has printed."""
    with boot(("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        yield bench, set_up(bench["laptop"]).check()


def prepare(laptop: Machine) -> None:
    laptop.write("/etc/sudoers.d/pat", SUDO, mode=0o440)
    laptop.run(f"{UR} setup --yes", user="pat", timeout=900).check()  # it installs packages


# The bench's network is one to trust; tests of the first contact itself give fingerprints, or none.
TRUSTING = ("--yes", "--robot-login")


def command(host: str, name: str, *options: str, trusting: bool = True) -> str:
    # What programs need takes minutes to install: test_ready_to_run.py is about that.
    words = " ".join([*(TRUSTING if trusting else ()), *options])
    return f"{UR} robot setup {host} --name {name} --base magni --no-programs --passwords-from 0 {words}"


def set_up(
    laptop: Machine, host: str = "robot.local", name: str = "bob", current: str = "ros", new: str = PASSWORD
) -> Done:
    return laptop.run(command(host, name), user="pat", stdin=f"{current}\n{new}\n", timeout=900)


def fingerprint(machine: Machine) -> str:
    """The fingerprint of its host key, as its user reads it at its own screen."""
    return machine.run("ssh-keygen -lf /etc/ssh/ssh_host_ed25519_key.pub").check().out.split()[1]


def set_up_two(
    laptop: Machine,
    hosts: tuple[str, str] = ("robot", "robot2"),
    current: str = "ros",
    new: str = PASSWORD,
    option: str = "",
) -> Done:
    """Two robots with one command."""
    robots = "".join(
        f"- {{host: {old}.local, name: {name}, base: magni}}\n" for old, name in zip(hosts, ("bob", "eve"), strict=True)
    )
    laptop.write("/home/pat/robots.yaml", f"robots:\n{robots}")
    line = f"{UR} robot setup --from robots.yaml --no-programs --passwords-from 0 {' '.join(TRUSTING)} {option}"
    return laptop.run(line, user="pat", stdin=f"{current}\n{new}\n", timeout=900).check()


def test_fresh_robot_becomes_ready_and_a_second_run_changes_nothing(ready: tuple[Bench, Done]) -> None:
    bench, done = ready
    laptop, robot = bench["laptop"], bench["robot"]
    assert "NO" not in done.out
    assert "ready after" in done.out

    again = set_up(laptop, "bob.local", current="").check()
    assert "nothing to do" in again.out
    assert "bob: packages" not in again.out

    # The old password is gone, the new one is there, and sshd still refuses strangers.
    for word, good in (("ros", False), (PASSWORD, True)):
        assert (robot.run("su -c true ros", user="pat", stdin=f"{word}\n").code == 0) is good


def test_robot_takes_the_time_from_the_viewer(ready: tuple[Bench, Done]) -> None:
    laptop, robot = ready[0]["laptop"], ready[0]["robot"]
    # ^ is a server; * one that is followed.
    robot.wait_for(f"chronyc -n sources | grep -q '^^\\* {laptop.address}'", deadline=120)


def test_topics_arrive_both_ways_between_laptop_and_robot(ready: tuple[Bench, Done]) -> None:
    laptop, robot = ready[0]["laptop"], ready[0]["robot"]
    laptop.run(f"{UR} use bob", user="pat").check()
    users = {"laptop": "pat", "robot": "ros"}
    for speaker, listener in ((laptop, robot), (robot, laptop)):
        talk = f"rostopic pub -r 10 /from_{speaker.name} std_msgs/String 'data: hello from {speaker.name}'"
        with running(speaker, talk, users[speaker.name]):
            said = listener.wait_for(
                f"timeout 10 rostopic echo -n 1 /from_{speaker.name}", user=users[listener.name], deadline=60
            )
            assert f"hello from {speaker.name}" in said.out


def test_wrong_password_is_named_and_changes_nothing(untouched: Bench) -> None:
    laptop, robot = untouched["laptop"], untouched["robot"]
    done = set_up(laptop, current="not-it", new="")
    assert done.code == 2
    assert "the login was refused" in done.err
    assert "Traceback" not in done.err
    assert robot.read("/etc/hostname") == "robot\n"


def test_user_who_may_not_use_sudo_is_named_and_nothing_is_changed(untouched: Bench) -> None:
    laptop, robot = untouched["laptop"], untouched["robot"]
    robot.run("useradd -m guest && chpasswd", stdin="guest:guest\n").check()
    done = set_up(laptop, host="guest@robot.local", current="guest", new="")
    assert done.code == 2
    assert "guest may not use sudo there" in done.err
    assert robot.read("/etc/hostname") == "robot\n"


def test_password_that_must_be_changed_at_the_first_login_is_changed(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    robot.run("chage -d 0 ros").check()
    without = set_up(laptop, new="")
    assert without.code == 2
    assert "has to be changed at the first login" in without.err
    assert "ssh ros@robot.local" in without.err
    assert robot.read("/etc/hostname") == "robot\n"
    short = set_up(laptop, new="x")
    assert short.code == 2
    assert "the new password is refused" in short.err
    done = set_up(laptop).check()
    assert "ready after" in done.out


def test_reboot_that_the_robot_did_not_hear_of_is_told_again(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    deaf = '#!/bin/sh\n[ "$1" = reboot ] || exec /usr/bin/systemctl "$@"\nrm /usr/local/sbin/systemctl\n'
    robot.write("/usr/local/sbin/systemctl", deaf, mode=0o755)
    done = set_up(laptop).check()
    assert "reboot as bob.local once more" in done.out
    assert "ready after" in done.out


def test_name_of_another_computer_is_refused(untouched: Bench) -> None:
    done = set_up(untouched["laptop"], name="laptop")
    assert done.code == 2
    assert "taken" in done.err


def test_robot_that_was_flashed_again_needs_consent(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    set_up(laptop, name="robot").check()
    robot.run("rm /etc/ssh/ssh_host_*; ssh-keygen -A; systemctl restart ssh").check()
    done = set_up(laptop, name="robot", current=PASSWORD)
    assert done.code == 2
    assert "--new-host-key" in done.err
    # The word alone is no consent to whatever key is offered.
    again, passwords = command("robot.local", "robot", "--new-host-key", trusting=False), f"{PASSWORD}\n\n"
    asked = laptop.run(again, user="pat", stdin=passwords, timeout=400)
    assert asked.code == 2
    assert f"--host-key {fingerprint(robot)}" in asked.err
    line = f"{again} --host-key {fingerprint(robot)}"
    laptop.run(line, user="pat", stdin=passwords, timeout=400).check()
    set_up(laptop, name="robot").check()


def test_two_robots_are_set_up_at_once() -> None:
    with boot(("laptop", "robot", "robot2")) as bench:
        laptop = bench["laptop"]
        prepare(laptop)
        shown = set_up_two(laptop, option="--dry-run")
        for robot, name in (("robot", "bob"), ("robot2", "eve")):
            assert f"{name} (ros@{robot}.local):" in shown.out
            assert f'+name: "{name}"' in shown.out
            assert bench[robot].run("cat /etc/ubiquity/robot.yaml; ls -d /home/ros/.ssh").out == ""
        interrupt_two(laptop)
        done = set_up_two(laptop)
        assert done.out.count("ready after") == 2
        seen = laptop.wait_for(f"{UR} robots", user="pat")
        assert seen.out.count("magni") == 2
        assert bench["robot"].address in seen.out
        said = laptop.run(f"{UR} shell eve cat /etc/hostname", user="pat").check()
        assert said.out == "eve\n"
        again = set_up_two(laptop, ("bob", "eve"), current=PASSWORD, new="")
        assert again.out.count("nothing to do") == 2


def interrupt_two(laptop: Machine) -> None:
    """Ctrl-C ends a set-up of two robots at once, and all that it has started."""
    line = f"{UR} robot setup --from robots.yaml --no-programs --passwords-from 0 {' '.join(TRUSTING)}"
    words = laptop.command_line(f"echo $$; exec {line}", user="pat")
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin
        assert process.stdout
        process.stdin.write(f"ros\n{PASSWORD}\n")
        process.stdin.close()
        number = process.stdout.readline().strip()
        logs = ".local/state/ubiquity_launches/fleet"
        for name in ("bob", "eve"):
            laptop.wait_for(f"grep -q ^packages {logs}/robot_setup-{name}.log", user="pat", deadline=180)
        laptop.run(f"kill -INT {number}").check()
        process.stdout.read()
        assert process.wait(60) == 130
    wait_until(lambda: not laptop.run("ls -d /tmp/ur-*").out, "its folders go", 60)
    wait_until(lambda: laptop.run("pgrep -u pat -x ssh").code != 0, "its connections end", 60)


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
