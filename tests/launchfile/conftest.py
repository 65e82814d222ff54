import json
import os
import re
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from ur.launchfile.dump import dump_plan
from ur.launchfile.load import load_plan
from ur.launchfile.plan.commands import run_command
from ur.launchfile.world.system import SystemWorld

HERE = Path(__file__).parent
BASE_ENVIRONMENT = {
    "PATH": os.environ.get("PATH", "/usr/bin:/bin"),
    "HOME": "/home/robot",
    "ROS_PACKAGE_PATH": str(HERE),
    "LC_ALL": "C.UTF-8",
}
_DIRECTIVE = re.compile(r"<!--case (.*?)-->")


class Reference:
    """The installed roslaunch in a process of its own: says what it makes of launch files."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            ["/usr/bin/python3", str(HERE / "roslaunch_reference.py")],  # the one that Debian's roslaunch runs in
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, "PYTHONPATH": str(HERE.parents[1] / "src")},
        )

    def load(self, files: Sequence[str], arguments: Sequence[str], environment: Mapping[str, str]) -> dict[str, Any]:
        """What roslaunch loads, in the form of dump_plan."""
        request = {"files": list(files), "arguments": list(arguments), "environment": dict(environment)}
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        answer: dict[str, Any] = json.loads(self._process.stdout.readline())
        return answer

    def close(self) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.stdout.close()
        self._process.wait(timeout=60)


class PredictableWorld(SystemWorld):
    """The real computer, but anonymous names are the same every time."""

    def make_anonymous(self, prefix: str) -> str:
        return f"{prefix}_anonymous"


@pytest.fixture(scope="session")
def reference() -> Iterator[Reference]:
    """The oracle, one for all tests."""
    oracle = Reference()
    yield oracle
    oracle.close()


def read_case(path: Path) -> tuple[list[str], dict[str, str]]:
    """Arguments and environment that a corpus file asks for in its first line."""
    first = path.read_bytes().split(b"\n", 1)[0].decode("utf-8", "replace")
    directive = _DIRECTIVE.match(first)
    arguments: list[str] = []
    environment = dict(BASE_ENVIRONMENT)
    for part in directive.group(1).split("; ") if directive else []:
        kind, _, text = part.partition(": ")
        if kind == "arguments":
            arguments = re.findall(r"\S+:=(?:\$\([^)]*\)|\S*)", text)
        else:
            environment.update({name: value for name, _, value in (item.partition("=") for item in text.split(" "))})
    return arguments, environment


def our_plan(files: Sequence[str], arguments: Sequence[str], environment: Mapping[str, str]) -> dict[str, Any]:
    """What we load, in the same form."""
    plan = load_plan(files, arguments, PredictableWorld(environment))
    dumped = dump_plan(plan, run=run_command)
    if dumped["ok"]:
        dumped["commands"] = [
            [command.command, *([command.file] if command.command == "dump" else []), command.name]
            for command in plan.commands
        ]
    decoded: dict[str, Any] = json.loads(json.dumps(dumped))
    return decoded


def differences(ours: dict[str, Any], theirs: dict[str, Any]) -> list[str]:
    """Where two dumps differ; empty when they mean the same."""
    if ours["ok"] != theirs["ok"]:
        return [f"ours: {ours.get('error', 'accepted')} | theirs: {theirs.get('error', 'accepted')}"]
    if not ours["ok"]:
        return []
    return [
        f"{key}: ours {ours[key]!r} | theirs {theirs[key]!r}"
        for key in ours
        if json.dumps(ours[key], sort_keys=True) != json.dumps(theirs[key], sort_keys=True)
    ]


@pytest.fixture
def compare(reference: Reference) -> Callable[[Path], list[str]]:
    """Compares what a corpus file means to us and to roslaunch: gives one line per difference."""

    def compare_file(path: Path) -> list[str]:
        arguments, environment = read_case(path)
        theirs = reference.load([str(path)], arguments, environment)
        ours = our_plan([str(path)], arguments, environment)
        return [f"{path.name}: {line}" for line in differences(ours, theirs)]

    return compare_file


@pytest.fixture(scope="session")
def base_environment() -> dict[str, str]:
    """An environment that names our corpus as a package."""
    return BASE_ENVIRONMENT


@pytest.fixture(scope="session")
def load_ours() -> Callable[..., dict[str, Any]]:
    """our_plan, for tests in other files."""
    return our_plan


@pytest.fixture(scope="session")
def compare_dumps() -> Callable[..., list[str]]:
    """differences, for tests in other files."""
    return differences
