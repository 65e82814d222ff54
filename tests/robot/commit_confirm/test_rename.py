"""Another name for a robot: every place gets it, and what belongs to others stays."""

import base64
import hmac

import pytest

from ur.robot.commit_confirm.guarded import list_changes
from ur.robot.commit_confirm.rename import (
    ANNOUNCEMENT,
    WantedKnownName,
    name_robot_file,
    plan_rename,
    rename_known_host,
)
from ur.robot.robot_file import ROBOT_FILE
from ur.robot.setup.facts import ABSENT, ComputerFacts, FileState
from ur.robot.setup.keys import HOST_KEY, KNOWN_HOSTS
from ur.robot.setup.robot_states import CLOUD, WantedRobot, announcement, robot_file

KEY = "ssh-ed25519 AAAA root@bob\n"
BOB = WantedRobot("bob", "magni", "lidar")
FILES = {
    str(ROBOT_FILE): FileState(robot_file(BOB), 0o644, "root"),
    ANNOUNCEMENT: FileState(announcement(BOB, "ros"), 0o644, "root"),
    HOST_KEY: FileState(KEY, 0o644, "root"),
    CLOUD: ABSENT,
    KNOWN_HOSTS: FileState("laptop.local,laptop ssh-ed25519 BBBB\nbob.local,bob ssh-ed25519 AAAA\n", 0o600, "ros"),
    "/etc/hosts": FileState("127.0.0.1\tlocalhost\n127.0.1.1\tbob\n", 0o644, "root"),
    "/etc/hostname": FileState("bob\n", 0o644, "root"),
}


def facts(**changed: FileState) -> ComputerFacts:
    names = {"robot": str(ROBOT_FILE), "announcement": ANNOUNCEMENT, "key": HOST_KEY, "cloud": CLOUD}
    files = {**FILES, "/etc/cloud/cloud.cfg.d/99-ubiquity.cfg": ABSENT}
    files |= {names[name]: state for name, state in changed.items()}
    return ComputerFacts("ros", "/home/ros", "bob", "debian bookworm", "1", frozenset(), files=files)


def test_every_place_gets_the_new_name() -> None:
    change = plan_rename(facts(), "eve")
    written = {str(command.stdin) for planned in list_changes(change, facts()) for command in planned.commands}
    assert robot_file(WantedRobot("eve", "magni", "lidar")) in written
    assert announcement(WantedRobot("eve", "magni", "lidar"), "ros") in written
    assert "laptop.local,laptop ssh-ed25519 BBBB\neve.local,eve ssh-ed25519 AAAA\n" in written
    assert "127.0.0.1\tlocalhost\n127.0.1.1\teve\n" in written
    assert "eve\n" in written


def test_the_way_back_has_the_old_name() -> None:
    change = plan_rename(facts(), "eve")
    assert "hostname eve" in change.live
    assert "hostname bob" in change.back
    assert change.early == "hostname bob"


def test_what_is_not_there_is_left_alone() -> None:
    state = facts(robot=ABSENT, announcement=ABSENT, key=ABSENT)
    titles = [planned.title for planned in list_changes(plan_rename(state, "eve"), state)]
    assert titles == ["host name (hosts)", "host name"]


def test_cloud_init_is_told_to_keep_the_name() -> None:
    state = facts(cloud=FileState("x", 0o644, "root"))
    assert "cloud-init" in [planned.title for planned in list_changes(plan_rename(state, "eve"), state)]


def test_own_lines_of_a_robot_file_stay() -> None:
    text = 'name: bob # the old one\nbase: "magni"\ndevices:\n  name: front\n'
    assert name_robot_file(text, "eve") == 'name: "eve"\nbase: "magni"\ndevices:\n  name: front\n'


def hashed(name: str) -> str:
    digest = hmac.digest(b"salt", name.encode(), "sha1")
    return f"|1|{base64.b64encode(b'salt').decode()}|{base64.b64encode(digest).decode()} ssh-rsa CCCC"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", "eve.local,eve ssh-ed25519 AAAA\n"),
        ("bob.local,bob ssh-ed25519 AAAA\n", "eve.local,eve ssh-ed25519 AAAA\n"),
        ("bob.local,10.0.0.5 ssh-ed25519 AAAA\n", "10.0.0.5 ssh-ed25519 AAAA\neve.local,eve ssh-ed25519 AAAA\n"),
        ("# bob.local\n@revoked bob.local x\n", "# bob.local\n@revoked bob.local x\neve.local,eve ssh-ed25519 AAAA\n"),
        (f"{hashed('bob.local')}\n{hashed('tom.local')}\n", f"{hashed('tom.local')}\neve.local,eve ssh-ed25519 AAAA\n"),
        ("eve.local ssh-rsa OLD\nno newline", "no newline\neve.local,eve ssh-ed25519 AAAA\n"),
        ("|1|not base64|x ssh-rsa CCCC\n", "|1|not base64|x ssh-rsa CCCC\neve.local,eve ssh-ed25519 AAAA\n"),
    ],
)  # fmt: skip
def test_known_hosts_hold_the_key_under_the_new_name_only(before: str, after: str) -> None:
    assert rename_known_host(before, "bob", "eve", KEY) == after
    assert rename_known_host(after, "bob", "eve", KEY) == after


def test_second_run_changes_no_known_hosts() -> None:
    state = FileState("eve.local,eve ssh-ed25519 AAAA\ntom ssh-rsa B\n", 0o600, "ros")
    known = ComputerFacts("ros", "/home/ros", "eve", "", "1", frozenset(), files={KNOWN_HOSTS: state})
    assert WantedKnownName("key", "bob", "eve", KEY).plan(known) is None
