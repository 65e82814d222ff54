"""What may be wrong with a robot that is set up: each is named, and once it is mended the same command goes on."""

from concurrent.futures import Future, ThreadPoolExecutor

from tests.hosts.bench import Bench, Machine
from tests.hosts.test_robot_setup import PASSWORD, command, pair, running, set_up
from tests.hosts.test_robot_setup_interrupted import run_until

OTHER = "other-secret-1414"
__all__ = ["pair"]
FULL = (
    "mkdir -p /etc/ubiquity && mount -t tmpfs -o size=4k tmpfs /etc/ubiquity && "
    "{ cat /dev/zero >/etc/ubiquity/full 2>/dev/null; df /etc/ubiquity | grep -q 100%; }"
)
# As apt-get update of the first boot: it holds the lock that no option of apt-get waits for.
APT = """\
import fcntl, os, time
lock = open("/var/lib/apt/lists/lock", "w")
fcntl.lockf(lock, fcntl.LOCK_EX)
open("/run/locked", "w").close()
while os.path.exists("/run/locked"):
    time.sleep(0.05)
"""
# A change that takes as long as this file is there.
SLOW = """\
#!/bin/sh
while [ "$1" = try-restart ] && [ -e /usr/local/sbin/systemctl ]; do sleep 0.1; done
exec /usr/bin/systemctl "$@"
"""
# The new password is set, and nobody is told: the network ends in the same moment.
CHANGE = """\
#!/bin/sh
rm /usr/local/sbin/chpasswd
/usr/sbin/chpasswd || exit
touch /run/changed
exec sleep 600
"""


def test_troubles_are_named_and_a_next_run_goes_on(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    robot.run(FULL).check()
    refused = set_up(laptop)
    assert refused.code == 2
    assert "robot file: " in refused.err
    assert "No space left on device" in refused.err
    robot.run("umount /etc/ubiquity").check()

    kept = robot.read("/etc/apt/sources.list")
    robot.run("mv /srv/offered /srv/away; rm -rf /var/lib/apt/lists/*").check()
    robot.write("/etc/apt/sources.list", "deb http://packages.invalid/debian bookworm main\n")
    away = set_up(laptop)
    assert away.code == 2
    assert "packages: it does not reach its package servers: " in away.err
    assert "packages.invalid" in away.err
    robot.run("mv /srv/away /srv/offered").check()
    robot.write("/etc/apt/sources.list", kept)

    wait_for_apt(laptop, robot)
    hold_the_lock(laptop, robot)
    start_two_at_once(laptop, robot)
    assert "nothing to do" in set_up(laptop, "bob.local", current="").check().out
    change_password_without_an_answer(laptop, robot)
    done = set_up(laptop, "bob.local", current=PASSWORD, new=OTHER).check()
    assert "nothing to do" in done.out
    assert "NO" not in done.out


def wait_for_apt(laptop: Machine, robot: Machine) -> None:
    """Something else installs packages: that is said, and waited for."""
    robot.write("/root/apt.py", APT)
    line = "bob: packages (python3 installs something there: waiting for its end)"

    def end(_: int) -> None:
        robot.run("rm /run/locked").check()

    def stop(number: int) -> None:
        laptop.run(f"kill -INT {number}")

    with running(robot, "python3 /root/apt.py", "root"):
        robot.wait_for("[ -e /run/locked ]", deadline=60)
        strikes = {line: end, "bob: announcement": stop}
        said, _ = run_until(laptop, command("robot.local", "bob"), f"ros\n{PASSWORD}\n", strikes)
    assert line in said
    assert "bob: announcement" in said


def change_password_without_an_answer(laptop: Machine, robot: Machine) -> None:
    """The network is cut while the password is changed."""
    robot.write("/usr/local/sbin/chpasswd", CHANGE, mode=0o755)

    def cut(_: int) -> None:
        robot.wait_for("[ -e /run/changed ]", deadline=60)
        robot.cut()

    said, code = run_until(laptop, command("bob.local", "bob"), f"{PASSWORD}\n{OTHER}\n", {"bob: password": cut})
    assert code == 2
    assert "the connection has ended" in "".join(said)
    robot.restore()
    assert robot.run("su -c true ros", user="pat", stdin=f"{OTHER}\n").code == 0
    laptop.wait_for(f"timeout 5 ssh-keyscan -T 2 {robot.address} 2>/dev/null | grep -q ed25519", deadline=60)


def hold_the_lock(laptop: Machine, robot: Machine) -> None:
    """Another viewer sets it up, and goes on doing so."""
    robot.run("echo eve@other >/run/ubiquity-setup.lock").check()
    with running(robot, "flock /run/ubiquity-setup.lock sleep 600", "root"):
        robot.wait_for("! flock -n /run/ubiquity-setup.lock true", deadline=60)
        done = set_up(laptop)
    assert done.code == 2
    assert "bob: eve@other is setting it up: waiting until that is done" in done.out
    assert "is being set up already, by eve@other" in done.err
    assert done.err.count("error:") == 1
    robot.run("pkill -x sleep")
    robot.wait_for("flock -n /run/ubiquity-setup.lock true", deadline=60)


def start_two_at_once(laptop: Machine, robot: Machine) -> None:
    """The same command twice at the same time: the second waits, and spoils nothing."""
    line, answers = command("robot.local", "bob"), f"ros\n{PASSWORD}\n"
    robot.write("/usr/local/sbin/systemctl", SLOW, mode=0o755)
    waiting = f"bob: pat@{laptop.name} is setting it up: waiting until that is done"
    with ThreadPoolExecutor(1) as pool:

        def go_on(_: int) -> None:
            robot.run("rm /usr/local/sbin/systemctl").check()

        def start(_: int) -> None:
            second.append(pool.submit(run_until, laptop, line, answers, {waiting: go_on}))

        second: list[Future[tuple[list[str], int]]] = []
        said, code = run_until(laptop, line, answers, {"bob: time from the viewer": start})
        others_words, other = second[0].result()
    assert code == 0, said
    assert waiting in others_words
    assert other in (0, 2)
    assert "Traceback" not in "".join(others_words)
