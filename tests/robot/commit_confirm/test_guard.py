"""The guard on a robot, run for real in a folder of its own: whatever ends it, the old state is back."""

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

from ur.robot.commit_confirm.guard import (
    BUSY,
    EARLY,
    ENDED,
    FOLDER,
    GUARD,
    LATE,
    UNIT,
    arm_script,
    confirm_script,
    parse_last,
    pending_script,
    state_script,
)
from ur.robot.commit_confirm.guarded import GuardedChange, Order, pack_order
from ur.robot.setup.facts import ComputerFacts, FileState
from ur.robot.setup.lock import LOCK_FILE
from ur.robot.setup.wanted import WantedFile

TOOLS = ("systemctl", "systemd-run", "sync", "sleep")  # what would touch this computer, or takes time
BOOT_ID = "/proc/sys/kernel/random/boot_id"


@dataclass
class RobotDisk:
    """A folder that stands for a robot's disk; scripts run here with their paths moved into it."""

    folder: Path

    def __post_init__(self) -> None:
        for name in ("bin", "units/multi-user.target.wants", "etc/folder"):
            (self.folder / name).mkdir(parents=True)
        for tool in TOOLS:
            path = self.folder / "bin" / tool
            path.write_text(f'#!/bin/sh\necho {tool} "$@" >>{self.folder}/calls\n')
            path.chmod(0o755)
        (self.folder / "boot_id").write_text("this boot\n")
        self.write("etc/name", "old\n")
        self.write("etc/folder/kept", "old\n")

    def write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text)

    def read(self, name: str) -> str:
        return (self.folder / name).read_text()

    def names(self, name: str) -> list[str]:
        return sorted(path.name for path in (self.folder / name).iterdir())

    def move(self, script: str) -> str:
        for path, name in (
            (FOLDER, "change"),
            (FOLDER.rpartition("/")[0], ""),
            ("/etc/systemd/system", "units"),
            (LOCK_FILE, "lock"),
            (BOOT_ID, "boot_id"),
        ):
            script = script.replace(path, str(self.folder / name))
        return script.replace("PATH=/usr/local/sbin", f"PATH={self.folder}/bin:/usr/local/sbin")

    def run(self, script: str, given: str = "", *words: str) -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}"}
        return subprocess.run(
            ["sh", "-c", self.move(script), "sh", *words],
            input=given,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
            env=environment,
        )

    def arm(self, live: str = ":", wait: int = 0, identity: str = "abc") -> subprocess.CompletedProcess[str]:
        name, back = str(self.folder / "etc/name"), f"echo went back >>{self.folder}/calls"
        facts = ComputerFacts(
            "ros", "/home/ros", "bob", "", "1", frozenset(), files={name: FileState("old\n", 0o644, "root")}
        )
        change = GuardedChange(
            "rename bob to eve",
            (WantedFile("name", name, "new\n"),),
            live=f"cd {self.folder}/etc; echo x >folder/added; rm folder/kept; {live}",
            back=back,
            early=f"echo at boot >>{self.folder}/calls",
            also_kept=(f"{self.folder}/etc/folder", f"{self.folder}/etc/absent"),
        )
        order = pack_order(Order(identity, "pat@laptop", wait, change), facts)
        done = self.run(arm_script(identity, change.title), order.reveal())
        apply = self.folder / "change/pending/apply"
        if apply.exists():
            apply.write_text(self.move(apply.read_text()))
        return done

    def guard(self, *words: str) -> str:
        return self.run(GUARD, "", *words).stdout

    def assert_old(self) -> None:
        assert self.read("etc/name") == "old\n"
        assert self.read("etc/folder/kept") == "old\n"
        assert self.names("etc") == ["folder", "name"]
        assert self.names("etc/folder") == ["kept"]
        self.assert_nothing_left()

    def assert_nothing_left(self) -> None:
        assert self.names("change") == ["last", "lock"]
        assert self.names("units") == ["multi-user.target.wants"]
        assert self.names("units/multi-user.target.wants") == []

    def last(self) -> tuple[bool, str]:
        done = self.run(confirm_script("abc"))
        assert done.returncode == ENDED
        ended = parse_last("abc", done.stdout)
        assert ended
        return ended.confirmed, ended.reason


@pytest.fixture
def robot(tmp_path: Path) -> RobotDisk:
    return RobotDisk(tmp_path)


def test_arming_changes_nothing_and_starts_the_guard(robot: RobotDisk) -> None:
    assert robot.arm().returncode == 0
    assert robot.read("etc/name") == "old\n"
    place = robot.read("change/pending/keeps").splitlines().index(str(robot.folder / "etc/name"))
    assert robot.read(f"change/pending/old/{place + 1}") == "old\n"
    assert robot.read("change/guard") == robot.move(GUARD)
    assert "guard boot" in robot.read("units/ur-change-boot.service")
    assert (robot.folder / "units/multi-user.target.wants/ur-change-boot.service").exists()
    assert "systemd-run --quiet --collect --unit=ur-change-abc" in robot.read("calls")


def test_all_of_it_is_for_root_alone(robot: RobotDisk) -> None:
    robot.arm()
    assert (robot.folder / "change").stat().st_mode & 0o777 == 0o700
    made = [path for path in (robot.folder / "change").rglob("*") if "old" not in path.parts]
    assert {path.stat().st_mode & 0o077 for path in made} == {0}


def test_change_that_nobody_confirms_is_taken_back(robot: RobotDisk) -> None:
    assert robot.run(pending_script()).returncode == 0
    robot.arm()
    said = robot.guard()
    assert "rename bob to eve: asked for by pat@laptop; begins" in said
    assert "it was not confirmed within 0 s; going back" in said
    assert "everything is as it was before" in said
    robot.assert_old()
    assert "went back" in robot.read("calls")
    assert robot.last() == (False, "it was not confirmed within 0 s")


def test_confirmed_change_stays(robot: RobotDisk) -> None:
    # It is confirmed as soon as it is made: by the last of its own words.
    robot.arm(live=f": >{FOLDER}/pending/applied; {confirm_script('abc')}".replace("-lt 100", "-lt 1"), wait=60)
    (robot.folder / "change/pending/live").write_text(robot.move(robot.read("change/pending/live")))
    assert "confirmed" in robot.guard()
    assert robot.read("etc/name") == "new\n"
    assert robot.names("etc/folder") == ["added"]
    robot.assert_nothing_left()
    assert robot.last() == (True, "")


def test_change_that_fails_is_taken_back_with_its_last_words(robot: RobotDisk) -> None:
    robot.arm(live="echo no such network >&2; echo; exit 4")
    assert "no such network; going back" in robot.guard()
    robot.assert_old()
    assert robot.last() == (False, "no such network")


def test_after_a_power_cut_it_is_taken_back_while_booting(robot: RobotDisk) -> None:
    robot.arm()
    robot.write("etc/name", "new\n")
    robot.write("change/pending/begun", "")
    robot.write("boot_id", "next boot\n")
    assert "switched off before this was confirmed" in robot.guard("boot")
    robot.assert_old()
    assert "at boot" in robot.read("calls")
    assert "went back" not in robot.read("calls")


def test_power_cut_after_the_confirmation_changes_nothing(robot: RobotDisk) -> None:
    robot.arm()
    robot.write("etc/name", "new\n")
    (robot.folder / "change/pending/open").rename(robot.folder / "change/pending/confirmed")
    robot.write("boot_id", "next boot\n")
    robot.guard("boot")
    assert robot.read("etc/name") == "new\n"
    robot.assert_nothing_left()


def test_what_makes_a_confirmed_change_permanent_is_repeated_until_it_succeeds(robot: RobotDisk) -> None:
    robot.arm()
    (robot.folder / "change/pending/open").rename(robot.folder / "change/pending/confirmed")
    robot.write("boot_id", "next boot\n")
    robot.write("change/pending/commit", f"ls step0.in >>{robot.folder}/calls && [ -e {robot.folder}/ready ]\n")
    robot.guard("boot")
    assert "pending" in robot.names("change")
    robot.write("ready", "")
    robot.guard()
    assert robot.read("calls").count("step0.in") == 2
    robot.assert_nothing_left()
    assert robot.last() == (True, "")


def test_guard_that_was_killed_takes_the_change_back_when_it_starts_again(robot: RobotDisk) -> None:
    robot.arm()
    robot.write("etc/name", "new\n")
    robot.write("change/pending/begun", "")
    assert "killed" in robot.guard()
    robot.assert_old()


def test_guard_that_was_killed_while_restoring_does_so_again(robot: RobotDisk) -> None:
    robot.arm()
    robot.write("change/pending/begun", "")
    (robot.folder / "change/pending/open").rename(robot.folder / "change/pending/closed")
    (robot.folder / "etc/folder").rename(robot.folder / "etc/folder.ur-back")
    robot.guard()
    robot.assert_old()


def test_change_that_was_armed_only_is_not_begun_after_a_boot(robot: RobotDisk) -> None:
    robot.arm()
    robot.write("boot_id", "next boot\n")
    robot.guard("boot")
    robot.assert_old()


def test_second_change_is_refused_by_the_name_of_the_first(robot: RobotDisk) -> None:
    robot.arm()
    asked = robot.run(pending_script())
    assert (asked.returncode, asked.stdout) == (BUSY, "rename bob to eve\npat@laptop\n")
    done = robot.arm(identity="def")
    assert done.returncode == BUSY
    assert done.stdout == "rename bob to eve\npat@laptop\n"
    assert robot.read("change/pending/id") == "abc\n"


def test_order_that_breaks_off_changes_nothing(robot: RobotDisk) -> None:
    change = GuardedChange("rename bob to eve", (), ":", ":")
    facts = ComputerFacts("ros", "/home/ros", "bob", "", "1", frozenset())
    whole = pack_order(Order("abc", "pat@laptop", 5, change), facts).reveal()
    done = robot.run(arm_script("abc", change.title), whole[: len(whole) // 3])
    assert done.returncode not in (0, BUSY)
    assert robot.names("change") == ["lock"]
    assert robot.names("units/multi-user.target.wants") == []


def test_change_while_the_robot_is_set_up_is_given_up(robot: RobotDisk) -> None:
    robot.arm()
    robot.write("lock", "tom@desktop\n")
    script = f"exec 7>>{LOCK_FILE}; flock 7; ({GUARD.replace('flock -w 15 8', 'flock -n 8')})"
    assert "it is being set up by tom@desktop at the moment" in robot.run(script).stdout
    robot.assert_old()


def test_only_a_change_that_is_made_can_be_confirmed(robot: RobotDisk) -> None:
    robot.arm()
    assert robot.run(confirm_script("abc")).returncode == EARLY
    assert robot.run(state_script("abc")).returncode == EARLY
    assert robot.run(confirm_script("def")).returncode == ENDED
    robot.write("change/pending/applied", "")
    (robot.folder / "change/pending/open").rename(robot.folder / "change/pending/closed")
    assert robot.run(confirm_script("abc")).returncode == LATE


def test_end_of_another_change_is_not_taken_for_ours() -> None:
    assert parse_last("abc", "def\nconfirmed\n\n") is None
    assert parse_last("abc", "") is None


def test_guard_runs_before_the_network_and_the_announcement_at_boot() -> None:
    before = " ".join(line for line in UNIT.splitlines() if line.startswith("Before="))
    for unit in ("network-pre.target", "NetworkManager.service", "avahi-daemon.service"):
        assert unit in before
