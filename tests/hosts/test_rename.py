"""`ur robot rename`: the robot has the new name everywhere, or the old one everywhere."""

import os
import signal
import subprocess

import pytest
from tests.hosts.bench import UR, Bench, Done, Machine, wait_until
from tests.hosts.managed import SNAPSHOT, find_command, wait_reached, wait_settled
from tests.hosts.test_doctor import pair
from tests.hosts.test_robot_setup import PASSWORD

__all__ = ["pair"]


def ur(laptop: Machine, words: str, password: str = PASSWORD) -> Done:
    return laptop.run(f"{UR} {words} --password-from 0", user="pat", stdin=f"{password}\n", timeout=300)


def test_robot_has_its_new_name_on_both_computers_and_after_a_reboot(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.run(f"{UR} use bob", user="pat").check()
    kept = laptop.run("tar c .ssh .config | base64", user="pat").check().out

    preview = ur(laptop, "robot rename bob eve --dry-run").check().out
    assert '+name: "eve"' in preview
    assert robot.read("/etc/hostname") == "bob\n"

    done = ur(laptop, "robot rename bob eve").check()
    assert "bob is called eve now" in done.out
    wait_settled(robot)
    assert laptop.run(f"{UR} use", user="pat").check().out.strip() == "eve"
    assert "bob" not in laptop.run("cat .ssh/known_hosts .config/ubiquity_launches/robots/*", user="pat").check().out
    found = robot.run("grep -rlw bob /etc/host* /etc/ubiquity /etc/avahi/services /home/ros/.ssh/known_hosts").out
    assert found == ""
    laptop.wait_for(f"{UR} robots | grep -q eve", user="pat", deadline=60)
    laptop.wait_for("rostopic list", user="pat", deadline=60)  # its master, under the name that is selected
    laptop.wait_for(f"{UR} doctor eve", user="pat", deadline=60)

    # This computer was stopped before it could take a note: a second run does that, and only that.
    laptop.run("rm -rf .ssh .config; base64 -d | tar x", user="pat", stdin=kept).check()
    again = ur(laptop, "robot rename bob eve").check()
    assert "no computer answers to bob.local, and eve is there" in again.out
    assert "here: host key of eve" in again.out
    wait_reached(laptop, "eve", robot.address)

    leader = robot.leader
    robot.run("systemctl reboot")
    robot.wait_rebooted(leader)
    wait_reached(laptop, "eve", robot.address)
    ur(laptop, "robot rename eve bob").check()
    wait_settled(robot)
    laptop.wait_for(f"{UR} doctor bob", user="pat", deadline=60)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("rename bob Eve!", "'Eve!' is not a valid host name"),
        ("rename bob laptop", "name 'laptop' is taken"),
        ("rename bob bob", "already named"),
        ("rename nobody eve", "no computer answers to this name"),
        ("network bob --address 10.77.0.99/24", "managed by systemd-networkd, expected NetworkManager; nothing"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line_and_changes_nothing(pair: Bench, words: str, said: str) -> None:
    robot = pair["robot"]
    before = robot.run(SNAPSHOT).check().out
    done = ur(pair["laptop"], f"robot {words}")
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err
    assert robot.run(SNAPSHOT).check().out == before
    wait_settled(robot)


def test_name_of_another_computer_is_refused(pair: Bench) -> None:
    # Another name of the laptop's, as another robot would have it.
    laptop = pair["laptop"]
    laptop.run(f"systemd-run --unit=other-name avahi-publish-address -R eve.local {laptop.address}").check()
    try:
        pair["robot"].wait_for("getent ahostsv4 eve.local", deadline=60)
        done = ur(laptop, "robot rename bob eve")
    finally:
        laptop.run("systemctl stop other-name").check()
    assert done.code == 2
    assert f"eve.local is another computer already ({laptop.address})" in done.err
    assert pair["robot"].read("/etc/hostname") == "bob\n"
    wait_until(lambda: laptop.run("getent ahostsv4 eve.local").code != 0, "eve.local is gone", 120)


def test_wrong_password_of_the_robot_is_named(pair: Bench) -> None:
    robot = pair["robot"]
    robot.run("mv /etc/sudoers.d/ros /root/").check()
    done = ur(pair["laptop"], "robot rename bob eve", password="wrong")
    robot.run("mv /root/ros /etc/sudoers.d/").check()
    assert done.code == 2
    assert "sudo refuses this password" in done.err


def test_rename_whose_viewer_was_killed_is_not_taken_for_done(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    line = f"{UR} robot rename bob eve --wait 300"
    process = subprocess.Popen(
        laptop.command_line(f"exec {line}", user="pat"),
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    with process.stdout as said:  # type: ignore[union-attr]  # it is a pipe
        number = find_command(laptop, line)
        assert "looking whether eve.local is free" in said.readline()
        assert "begins" in said.readline()
        os.kill(number, signal.SIGKILL)
    process.wait(60)
    done = ur(laptop, "robot rename bob eve")
    assert done.code == 2
    assert "not finished" in done.err
    # What watches over it is killed, too: it is started again, and goes back at once.
    robot.wait_for("[ -e /var/lib/ubiquity/change/pending/applied ]")
    robot.run("systemctl kill --signal=KILL 'ur-change-*.service'").check()
    wait_settled(robot)
    wait_reached(laptop, "bob", robot.address)
    assert "what watches over this was killed; going back" in robot.journal()
