"""Clients and a mux over a real master: who drives, and that what is late does not move the robot."""

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.e2e.terminal import ProgramTerminal
from tests.ros_session import ROOT, RosSession

pytestmark = pytest.mark.ros

PACKAGE = ROOT / "ubiquity_launches"
MUX = str(PACKAGE / "n_cmd_vel_mux" / "bin" / "twist_mux")
KEYBOARD = str(PACKAGE / "n_teleop_twist_keyboard" / "bin" / "teleop_twist_keyboard.py")
SOURCES = PACKAGE / "n_cmd_vel_mux" / "params" / "sources.yaml"


class Session(RosSession):
    """A mux without a robot, and clients."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, (sys.executable, "-m", "tests.ur_nodes.motion.lease.lease_test_node"))
        load = ["/usr/bin/rosparam", "load", str(SOURCES), "/cmd_vel_mux"]
        subprocess.run(load, env=self.env, check=True, timeout=60)
        self.mux = self.start_mux()

    def start_mux(self) -> subprocess.Popen[str]:
        return self.start(MUX, "__name:=cmd_vel_mux", "cmd_vel_out:=cmd_vel", "_base:=stage")

    def join(self, client: str, conduct: str = "drive") -> Any:
        return self.ask("join", client=client, conduct=conduct)

    def becomes(self, client: str, **expected: Any) -> Any:
        return self.ask("becomes", client=client, **expected)

    def request(self, client: str, action: str) -> None:
        self.ask("request", client=client, action=action)

    def keys(self, text: str, **environment: str) -> subprocess.CompletedProcess[str]:
        command = [KEYBOARD, "cmd_vel:=key_vel", "__name:=keys"]
        env = self.env | environment
        return subprocess.run(command, env=env, input=text, text=True, capture_output=True, timeout=120, check=False)

    def keyboard(self, name: str) -> ProgramTerminal:
        return ProgramTerminal(
            [KEYBOARD, "cmd_vel:=key_vel", f"__name:=keys_{name}"], self.env | {"UR_CLIENT_NAME": name}
        )


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    started = Session(tmp_path_factory.mktemp("lease"))
    try:
        started.ask("ready")
        yield started
    finally:
        started.close()


@pytest.fixture(autouse=True)
def unused(session: Session) -> Iterator[None]:
    """Each test ends with a lease that is free."""
    yield
    session.join("cleaner", "take")
    session.becomes("cleaner", mine=True, state="held")
    session.ask("leave", client="cleaner")
    session.ask("becomes", client="cleaner", state="free")


def test_client_that_vanishes_is_lost_and_is_replaced_on_purpose_only(session: Session) -> None:
    session.join("a")
    session.becomes("a", mine=True)
    session.ask("vanish", client="a")
    session.join("b", "watch")
    session.becomes("b", state="lost", holder="a-host")
    refused = session.keys("i", UR_CLIENT_NAME="laptop2")
    assert refused.returncode == 1
    assert "a-host (test) drove the robot until" in refused.stderr
    assert "out of reach" in refused.stderr
    with session.keyboard("laptop2") as keys:
        keys.wait_for("a-host (test) drove until")
        keys.type("i")
        keys.wait_for("not driving")
        keys.type("d")
        keys.type("i")
        keys.wait_for("▲ driving")
        keys.type("\x03")
        assert keys.process.wait(60) == 0
    session.becomes("b", state="free")
    session.ask("leave", client="b")


def test_keys_of_a_pipe_drive_only_where_nobody_else_does(session: Session) -> None:
    session.join("a")
    session.becomes("a", mine=True)
    refused = session.keys("i")
    assert refused.returncode == 1
    assert "a-host (test) drives the robot since" in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
    taken = session.keys("i", UR_LEASE="take", UR_CLIENT_NAME="laptop2")
    assert (taken.returncode, taken.stderr) == (0, "")
    session.becomes("a", mine=False)
    session.ask("leave", client="a")


def test_program_drives_from_its_first_command_and_not_from_its_start(session: Session) -> None:
    with session.keyboard("laptop") as keys:
        keys.wait_for("■ stopped")
        session.join("a")
        session.becomes("a", mine=True)  # while the keyboard has driven nothing
        session.ask("leave", client="a")
        keys.type("i")
        keys.wait_for("▲ driving")
        session.join("b", "watch")
        session.becomes("b", state="held", holder="laptop")
        session.ask("leave", client="b")


def test_screens_of_two_keyboards_say_who_drives(session: Session) -> None:
    with session.keyboard("laptop") as first:
        first.wait_for("■ stopped")
        first.type("i")
        first.wait_for("▲ driving")
        with session.keyboard("desktop") as second:
            second.wait_for("laptop (keyboard_drive) drives the robot since")
            second.type("i")
            second.wait_for("not driving")
            second.type("a")
            first.wait_for("desktop asks to drive; y: hand over")
            second.wait_for("asked to hand over")
            first.type("y")
            first.wait_for("desktop (keyboard_drive) drives the robot since")
            second.type("i")
            second.wait_for("▲ driving")
            first.type("d")
            second.wait_for("laptop took over at")
            first.type("i")
            first.wait_for("▲ driving")
            second.type("\x03")
            assert second.process.wait(60) == 0
        first.type("i")
        first.wait_for("▲ driving")
        session.join("a", "watch")
        session.becomes("a", state="held", holder="laptop")
        first.type("\x03")
        assert first.process.wait(60) == 0
        session.becomes("a", state="free")  # the end of the program releases the lease


def test_screen_says_when_the_robot_is_out_of_reach_and_recovers(session: Session) -> None:
    with session.keyboard("laptop") as keys:
        keys.wait_for("■ stopped")
        keys.type("i")
        session.join("a", "watch")
        session.becomes("a", state="held", holder="laptop")  # so challenges reach the keyboard
        session.mux.send_signal(signal.SIGSTOP)  # connections stay open, nothing comes any more
        try:
            keys.wait_for("no word from the robot for 1.")
        finally:
            session.mux.send_signal(signal.SIGCONT)
        keys.type("i")
        keys.wait_for("▲ driving")


def test_change_of_the_lease_that_was_announced_outlives_a_mux_that_is_killed_at_once(session: Session) -> None:
    for client in ("a", "b"):
        session.join(client, "watch")
    for client, other in (("a", "b"), ("b", "a"), ("a", "b")):
        announced = json.loads(session.ask("take_and_kill", client=client, pid=session.mux.pid))
        session.mux.communicate(timeout=60)
        session.running.remove(session.mux)
        session.ask("vanish", client=client)
        session.mux = session.start_mux()
        session.ask("ready")
        session.becomes(other, state="lost", holder=f"{client}-host")
        session.ask("mirrored", client=client, state="lost")
        lease = json.loads(session.ask("parameter"))
        assert lease["taken_from"] == announced["taken_from"]
        assert lease["until"] >= announced["since"]


def test_sources_of_the_library_are_read() -> None:
    assert [each["topic"] for each in yaml.safe_load(SOURCES.read_text())["topics"]] == [
        "joy_vel",
        "key_vel",
        "web_vel",
        "nav_vel",
    ]
