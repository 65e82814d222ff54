"""A laptop, a robot, and an attacker's computer in one network: nothing executes, no secret leaves, nothing hangs."""

import json
import re
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.hosts import announcer
from tests.hosts.bench import UR, Bench, Done, Machine, boot, wait_until
from tests.hosts.test_robot_setup import PASSWORD, command, fingerprint, prepare, running
from tests.hosts.test_robot_setup_secrets import MachineTerminal

pytestmark = [pytest.mark.timeout(1800)]
SECONDS = 150  # more than any command may take; it is ended then, which is a failure
OWN = "ros"  # the present password of a flashed robot
# The attacker's ssh server writes down each password that it is told, whether it takes it or not.
TRAP = "auth optional pam_exec.so expose_authtok quiet /usr/local/sbin/trap\n"
WRITE_DOWN = "#!/bin/sh\ntr '\\0' '\\n' >>/var/tmp/caught\necho >>/var/tmp/caught\n"
# Everything that is sent to its commands is written down, too; the answers are lies, of the kind that is asked for.
LIE = r"""#!/bin/bash
kind=$(cat /var/tmp/kind)
[[ $SSH_ORIGINAL_COMMAND != *"ubiquity: logged in"* ]] || { echo; echo ubiquity: logged in; exec cat >/dev/null; }
case $kind in
silent) exec sleep 3600 ;;
endless) (timeout 3600 cat >>/var/tmp/caught &) ; exec yes $'\e]52;c;eA==\a\e[2J eve: ready' ;;
noise) timeout 1 cat >>/var/tmp/caught; head -c 20000 /dev/urandom; printf '\e]52;c;eA==\a\e[2J\n' ;;
paths)
  timeout 1 cat >>/var/tmp/caught
  printf '{"files": {"../../escaped": ["link", 0, 0, false, "/etc/passwd"]}, "skipped": {}, "ignore": [],'
  printf '"rsync": true, "root": "/x", "machine": "m"}' ;;
twisted) # The truth, but for its numbers, its name, and keys that are more than one line.
  tee -a /var/tmp/caught | bash -c "$SSH_ORIGINAL_COMMAND" 2>&1 |
    LC_ALL=C sed -u -E 's/[0-9]+/²/g; s/ssh-ed25519/command="touch x" &/; s,/,../,g; s/$/\x1b]0;x\x07/' ;;
esac
"""
# One host key: ssh writes the others of a computer that it knows into known_hosts by itself.
LYING = "ForceCommand /usr/local/bin/lie\nHostKey /etc/ssh/ssh_host_ed25519_key\n"
SYSTEM_FILES = ".ssh .bashrc .profile .config/ubiquity_launches catkin_ws"


@pytest.fixture(scope="module")
def net() -> Iterator[Bench]:
    """A laptop that was set up, a robot that was just flashed, and a computer of somebody else."""
    with boot(("laptop", "robot", "attacker")) as bench:
        prepare(bench["laptop"])
        attacker = bench["attacker"]
        attacker.write("/usr/local/sbin/trap", WRITE_DOWN, mode=0o755)
        attacker.write("/usr/local/bin/lie", LIE, mode=0o755)
        attacker.write("/etc/pam.d/sshd", TRAP + attacker.read("/etc/pam.d/sshd"))
        attacker.run("touch /var/tmp/caught; chmod 666 /var/tmp/caught").check()
        attacker.run("sed -i 's/^#*UsePAM.*/UsePAM yes/' /etc/ssh/sshd_config; systemctl restart ssh").check()
        yield bench


def caught(net: Bench) -> str:
    """All that was told to the attacker's computer."""
    return net["attacker"].read("/var/tmp/caught")


def forget_caught(net: Bench) -> None:
    net["attacker"].write("/var/tmp/caught", "", mode=0o666)


@contextmanager
def in_place_of_the_robot(net: Bench, name: str) -> Iterator[None]:
    """The attacker's computer answers to the robot's name, and the robot does not, as one that is slower."""
    robot, attacker, laptop = net["robot"], net["attacker"], net["laptop"]
    robot.cut()
    try:
        call(attacker, name)
        laptop.run("systemctl restart avahi-daemon").check()  # what it knew of the name
        laptop.wait_for(f"getent ahostsv4 {name}.local | grep -q '^{attacker.address} '", deadline=60)
        yield
    finally:
        call(attacker, "attacker")
        robot.restore()
        robot.run("systemctl restart avahi-daemon").check()
        laptop.run("systemctl restart avahi-daemon").check()
        laptop.wait_for(f"getent ahostsv4 {name}.local | grep -q '^{robot.address} '", deadline=60)


def call(machine: Machine, name: str) -> None:
    machine.run(f"hostname {name}; systemctl restart avahi-daemon").check()
    machine.wait_for(f"avahi-resolve -4 -n {name}.local", deadline=60)


def ur(laptop: Machine, words: str, stdin: str = "") -> Done:
    """A command of the laptop's user, which ends by itself, with one line for each trouble, and harms no terminal."""
    done = laptop.run(f"timeout {SECONDS} {UR} {words}", user="pat", stdin=stdin, timeout=SECONDS + 60)
    said = done.out + done.err
    assert done.code != 124, f"{words} hangs: {said}"
    assert "Traceback" not in said, said
    assert "internal error" not in said, said
    assert not re.search(r"[\x00-\x08\x0b-\x1a\x1c-\x1f\x7f]|\x1b(?!\[[0-9;]*m)", said), f"{words}: {said!r}"
    return done


def snapshot(laptop: Machine) -> str:
    """What the user's files are that decide who logs in and what runs."""
    return laptop.run(
        f"find {SYSTEM_FILES} -type f -exec sha256sum {{}} + 2>/dev/null | sort -k 2; ls -A -I .bash_history . ..",
        user="pat",
    ).out


def check_untouched(laptop: Machine, before: str) -> None:
    assert snapshot(laptop) == before
    assert "sshfs" not in laptop.run("cat /proc/self/mounts").out
    assert laptop.run("ls -d /tmp/executed /home/pat/executed /home/escaped /home/pat/escaped").out == ""


def test_first_contact_without_a_terminal_sends_nothing(net: Bench) -> None:
    laptop, robot = net["laptop"], net["robot"]
    done = ur(laptop, command("robot.local", "bob", trusting=False).removeprefix(UR), f"{OWN}\n{PASSWORD}\n")
    assert done.code == 2
    assert f"--host-key {fingerprint(robot)}" in done.err
    assert not re.search(r"(Accepted|Failed) (password|publickey)", robot.journal())
    assert robot.run("ls -d /home/ros/.ssh").out == ""


def test_host_that_answers_first_gets_no_password(net: Bench) -> None:
    laptop, robot, attacker = net["laptop"], net["robot"], net["attacker"]
    right, passwords = fingerprint(robot), f"{OWN}\n{PASSWORD}\n"
    line = command("robot.local", "bob", trusting=False)
    with in_place_of_the_robot(net, "robot"):
        before = snapshot(laptop)
        given = ur(laptop, f"{line.removeprefix(UR)} --host-key {right}", passwords)
        assert given.code == 2
        assert f"its host key is {fingerprint(attacker)}, expected {right}" in given.err
        refuse_at_the_terminal(net)
        assert caught(net) == ""
        check_untouched(laptop, before)
        # Taken for the robot by mistake, it has another password, and does not learn the new one.
        attacker.run("chpasswd", stdin="ros:another\n").check()
        mistaken = ur(laptop, f"{line.removeprefix(UR)} --yes", passwords)
        assert mistaken.code == 2
        assert "the new password was not sent" in mistaken.err
        assert OWN in caught(net).split()
        assert PASSWORD not in caught(net)
        check_untouched(laptop, before)
    forget_caught(net)


def refuse_at_the_terminal(net: Bench) -> None:
    """The user compares: another fingerprint than the one that the robot shows is no consent, and neither is Enter."""
    for answer in (fingerprint(net["robot"]), ""):
        terminal = MachineTerminal(net["laptop"], "pat")
        terminal.answer("$ ", "ur robot setup robot.local --name bob --base magni --variant plain --no-programs")
        terminal.answer("or the fingerprint]", answer)
        terminal.answer("nothing was sent to it", "exit")
        terminal.close()
        assert fingerprint(net["attacker"]) in terminal.screen
        assert "present password" not in terminal.screen


def test_robot_is_set_up_once_its_fingerprint_was_confirmed_and_gets_no_login_here(net: Bench) -> None:
    laptop, robot = net["laptop"], net["robot"]
    allowed = laptop.run("cat .ssh/authorized_keys", user="pat").out
    terminal = MachineTerminal(laptop, "pat")
    terminal.answer("$ ", "ur robot setup robot.local --name bob --base magni --variant plain --no-programs")
    terminal.answer("or the fingerprint]", fingerprint(robot))
    terminal.answer("may bob log in to this computer", "n")
    terminal.answer("present password of ros@robot.local", OWN)
    terminal.answer("new password", PASSWORD)
    terminal.answer("the same again", PASSWORD)
    terminal.answer("ready after", "exit")
    terminal.close()
    assert laptop.run("cat .ssh/authorized_keys", user="pat").out == allowed
    assert robot.run("ssh -o BatchMode=yes pat@laptop.local true", user="ros").code == 255
    assert "no-login-there" not in ur(laptop, "doctor bob").out
    # Nobody is asked again, and what was decided stays.
    again = ur(laptop, command("bob.local", "bob", trusting=False).removeprefix(UR), f"{PASSWORD}\n\n")
    assert "nothing to do" in again.check().out


def test_changed_host_key_is_refused_by_every_command(net: Bench) -> None:
    laptop = net["laptop"]
    with in_place_of_the_robot(net, "bob"):
        before = snapshot(laptop)
        setup = command("bob.local", "bob", "--yes", trusting=False).removeprefix(UR)
        lines = [
            setup,
            "shell bob true",
            "sync bob --yes",
            "mount bob",
        ]
        lines += ["doctor bob --fix", "robot network bob", "robot wifi bob", "robot rename bob ann --password-from 0"]
        lines += ["boot status --robot bob"]
        for words in lines:
            done = ur(laptop, words, f"{PASSWORD}\nanother-secret\n")
            assert done.code != 0, f"{words}: {done.out}"
            assert "host key" in (done.out + done.err).lower(), f"{words}: {done.out} {done.err}"
        ur(laptop, "doctor --wireless bob --seconds 2")  # pings, which prove nothing and tell nothing
        assert "--new-host-key" in ur(laptop, setup, f"{PASSWORD}\n\n").err
        assert caught(net) == ""
        assert not re.search(r"Accepted (password|publickey)", net["attacker"].journal())
        check_untouched(laptop, before)


def test_crowd_of_hostile_announcements_hides_no_robot(net: Bench) -> None:
    laptop, robot, attacker = net["laptop"], net["robot"], net["attacker"]
    attacker.write("/root/announcer.py", Path(announcer.__file__).read_text())
    before = snapshot(laptop)
    with announcing(attacker):
        rows: list[dict[str, str]] = []
        shown = Done("", 0, "", "")

        def is_listed() -> bool:
            nonlocal shown
            shown = ur(laptop, "robots --json")
            rows[:] = json.loads(shown.out)
            return any(row["name"] == "bob" and row["address"] == robot.address for row in rows)

        # Once is enough, unless this computer is so busy that it does not read what arrives.
        wait_until(is_listed, "bob is listed among the crowd", 120)
        # One that comes late in the crowd is not looked at: it counts as one too many, whatever its shape.
        counted = [int(number) for number in re.findall(r"note: (\d+) announcements", shown.err)]
        assert sum(counted) >= 100, shown.err
        assert not any("option" in row["name"] or "control" in row["name"] for row in rows), rows
        assert ur(laptop, "shell bob cat /etc/hostname").check().out == "bob\n"
    check_untouched(laptop, before)
    assert caught(net) == ""


@contextmanager
def announcing(attacker: Machine) -> Iterator[None]:
    words = attacker.command_line(f"exec python3 /root/announcer.py {attacker.address}")
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        assert process.stdout.readline() == "sent\n"
        try:
            yield
        finally:
            process.stdout.close()
            process.terminate()
            wait_until(lambda: process.poll() is not None, "the announcements end", 60)


@pytest.fixture
def liar(net: Bench) -> Iterator[Machine]:
    """The attacker's computer as a robot `eve` that the laptop has set up once, and that lies since then."""
    laptop, attacker = net["laptop"], net["attacker"]
    call(attacker, "eve")
    host_key = attacker.read("/etc/ssh/ssh_host_ed25519_key.pub").split()[:2]
    key = laptop.run("cat .ssh/id_ed25519.pub", user="pat").check().out
    attacker.run("install -d -m 700 -o ros -g ros /home/ros/.ssh").check()
    attacker.write("/home/ros/.ssh/authorized_keys", key)
    attacker.run("chown ros: /home/ros/.ssh/authorized_keys").check()
    attacker.write("/etc/ssh/sshd_config.d/lie.conf", LYING)
    attacker.write("/var/tmp/kind", "noise\n")
    attacker.run("systemctl restart ssh").check()
    record = 'name: "eve"\nuser: "ros"\nbase: "magni"\nrobot_login: true\n'
    line = (
        f"echo 'eve.local,eve {' '.join(host_key)}' >>.ssh/known_hosts; cat >.config/ubiquity_launches/robots/eve.yaml"
    )
    laptop.run(line, user="pat", stdin=record).check()
    laptop.wait_for("getent ahostsv4 eve.local", deadline=60)
    yield attacker
    attacker.run("rm /etc/ssh/sshd_config.d/lie.conf; systemctl restart ssh").check()


COMMANDS = (
    *(
        "doctor eve",
        "doctor eve --fix",
        "sync eve --yes",
        "doctor --wireless eve --seconds 2",
        "boot status --robot eve",
    ),
    *("robot network eve", "robot wifi eve", "robot rename eve ann --password-from 0", "robots", "robots --json"),
    *("mount eve", "boot install --robot eve"),
)


def test_robot_that_lies_in_every_answer_reaches_nothing_here(net: Bench, liar: Machine) -> None:
    laptop = net["laptop"]
    setup = command("eve.local", "eve", "--robot-login", trusting=False).removeprefix(UR)
    laptop.run("mkdir -p catkin_ws/src robots", user="pat").check()  # where `ur mount` would put it
    before = snapshot(laptop)
    for kind in ("noise", "twisted", "paths", "endless"):
        liar.write("/var/tmp/kind", kind)
        for words in (*COMMANDS, setup):
            done = ur(laptop, words, f"{PASSWORD}\n\n")
            if not words.startswith(("robots", "doctor --wireless")):  # which list and measure whatever answers
                assert done.code != 0, f"{kind}: {words}: {done.out}"
            check_untouched(laptop, before)
    liar.write("/var/tmp/kind", "silent")
    for words in ("robots", "doctor eve", setup):
        ur(laptop, words, f"{PASSWORD}\n\n")
    check_untouched(laptop, before)


def test_true_robot_is_still_usable_afterwards(net: Bench) -> None:
    laptop = net["laptop"]
    assert ur(laptop, "shell bob cat /etc/hostname").check().out == "bob\n"
    assert "bob" in ur(laptop, "robots").out
    laptop.run(f"{UR} use bob", user="pat").check()
    with running(net["robot"], "rostopic pub -r 10 /hello std_msgs/String 'data: hello'", "ros"):
        heard = laptop.wait_for("timeout 10 rostopic echo -n 1 /hello", user="pat", deadline=60)
    assert "hello" in heard.out
