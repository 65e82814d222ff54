"""Answers of a robot to the scripts that run there over ssh: facts, the doctor, networks, services, runs, sync."""

import shutil
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.fuzz.target import Target
from tests.robot.doctor.pairs import PAIR

from ur.robot.boot.launch_file import find_launch
from ur.robot.boot.units import describe_status, parse_status
from ur.robot.commit_confirm.guard import parse_last
from ur.robot.commit_confirm.network_facts import parse_networks
from ur.robot.doctor.observe import parse_side
from ur.robot.doctor.rules import OBSERVE, diagnose
from ur.robot.doctor.summary import summarize
from ur.robot.mount import parse_mounts
from ur.robot.remote_run import ask_part
from ur.robot.setup.facts import FactsRequest, parse_facts
from ur.robot.ssh.host_key import parse_public_key
from ur.robot.ssh.shell import ShellResult
from ur.robot.sync.sync import list_workspaces
from ur.run.remote.protocol import parse_answer, parse_request
from ur.source.diagnostic import UserError

_WORDS = (
    *(b"\x1e", b"\x1ehome\n", b"\x1eend\n", b"\x1efile /etc/hosts\n", b"\x1eservice ssh\n", b"644 root file\n"),
    *(
        b"644 root folder\n",
        b"installed ",
        b"0x",
        b"100% packet loss",
        b"x11forwarding ",
        b"ssh-ed25519 ",
        b"%",
        b"/24",
    ),
    *(
        b"device wlan0\n",
        b"signal: ",
        b" dBm",
        b"kB",
        b"= 1/2/3/4",
        b"ActiveState=",
        b"Said=",
        b"NRestarts=",
        b"\\",
        b"\\:",
    ),
    *(b"active", b"path: ", b"ROS_MASTER_URI=", b"end\n", b"failed", b"\x00", "\u00b2".encode(), "\u0e51".encode()),
)


class _Robot:
    """A shell on a robot that gives the same answer to every command."""

    destination = "ros@bob.local"

    def __init__(self, answer: str) -> None:
        self._answer = answer

    def run(self, *_: object, **__: object) -> ShellResult:
        return ShellResult(0, self._answer, self._answer)


def _text(data: bytes) -> str:
    return data.decode(errors="surrogateescape")  # as ur.robot.ssh.shell reads what a robot prints


def _read_facts(data: bytes, _: Path) -> None:
    with suppress(UserError):
        parse_facts(FactsRequest("ros", frozenset({"/etc/hosts"}), frozenset({"ssh"}), frozenset({"ssh"})), _text(data))
    parse_last("x", _text(data))
    parse_mounts(_text(data))


def _diagnose(data: bytes, _: Path) -> None:
    side = parse_side(_text(data), OBSERVE)
    for pair in (replace(PAIR, remote=side), replace(PAIR, local=side)):
        for finding in diagnose(pair):
            for command in finding.commands:
                assert "\0" not in command.typed, "a zero byte in a command"
        summarize(pair)


def _read_networks(data: bytes, _: Path) -> None:
    networks = parse_networks(_text(data))
    networks.device_with("10.0.0.2")
    repr(networks.wireless)


def _read_services(data: bytes, _: Path) -> None:
    with suppress(UserError):
        parse_status(_text(data))
    for status in parse_status(f"{_text(data)}\x1eend\n"):
        list(describe_status(status))


def _read_remote_run(data: bytes, _: Path) -> None:
    robot: Any = _Robot(_text(data))
    for parse in (parse_answer, parse_request):
        with suppress(ValueError, TypeError):
            parse(_text(data))
    with suppress(UserError):
        ask_part(robot, "{}", 1.0)
    with suppress(UserError):
        find_launch(robot, "p", "a.launch", "bob")


def _sync(data: bytes, folder: Path) -> None:
    shutil.which = lambda *_, **__: "/usr/bin/rsync"  # type: ignore[assignment]  # the scan of this computer goes on
    robot: Any = _Robot(_text(data))
    with suppress(UserError):
        there = list_workspaces(robot, folder, None).there
        assert not any(".." in path.split("/") or path.startswith("/") for path in there.files), "a path leads out"


def _read_key(data: bytes, _: Path) -> None:
    with suppress(ValueError):
        key = str(parse_public_key(_text(data)))
        assert key.isascii(), "a key with other letters"
        assert key.isprintable(), "a key with control characters"


TARGETS = (
    Target("facts", _read_facts, _WORDS),
    Target("doctor", _diagnose, _WORDS),
    Target("networks", _read_networks, _WORDS),
    Target("services", _read_services, _WORDS),
    Target("remote_run", _read_remote_run, _WORDS),
    Target("sync", _sync, _WORDS),
    Target("public_key", _read_key, _WORDS),
)
