"""A program on two computers: the robot's nodes as a detached run there, the others here."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from types import FrameType

from ur.cli.launch_wishes import Wishes
from ur.cli.plan_files import Loaded
from ur.cli.shell import STRICT, robot_address
from ur.launchfile.plan.model import Plan
from ur.launchfile.world.protocol import World
from ur.robot.remote_run import ask_part
from ur.robot.ssh.openssh import Address, connect
from ur.robot.ssh.shell import quote
from ur.run.machines import take_part
from ur.run.part_side import END_SECONDS, START_SECONDS, Answer, Request, parse_answer
from ur.source.diagnostic import UserError, error

AGAIN_SECONDS = 2.0
MARGIN = 30.0  # s more than what the robot itself waits for: login and network
_ALIVE = ("-o", "BatchMode=yes", "-o", "ServerAliveInterval=3", "-o", "ServerAliveCountMax=3")


@dataclass(frozen=True, slots=True)
class Part:
    """A program whose robot's nodes run there. `here` is the rest; `run` is the id of the robot's run, '' for none."""

    here: Plan
    address: Address
    robot: str
    run: str
    detached: bool

    def follow(self) -> int:
        """Show what the robot's run prints until it ends or we are to end; returns the exit code.

        A connection that breaks is made again: the run goes on meanwhile. A detached run is left alone.
        """
        if self.detached or not self.run:
            return 0
        with _interrupted_by_signals():
            try:
                while (code := self._show()) == 255:
                    _say(f"{self.robot}: the connection is gone; {self.run} goes on there; trying again")
                    time.sleep(AGAIN_SECONDS)
                return code
            except KeyboardInterrupt:
                return 0

    def _show(self) -> int:
        line = quote("bash", "-lc", f"exec ur attach --plain {quote(self.run)}")
        sys.stdout.flush()
        process = subprocess.Popen(
            ["ssh", *STRICT, *_ALIVE, str(self.address), line], stdin=subprocess.DEVNULL, start_new_session=True
        )
        try:
            return process.wait()
        finally:
            if process.poll() is None:
                process.terminate()
                process.wait()


@contextmanager
def start_there(loaded: Loaded, words: Sequence[str], wishes: Wishes) -> Iterator[Part]:
    """Start the robot's nodes on the robot, or find them running; end the robot's run with the context.

    A run that is detached here and has no node here goes on. Raises UserError: no way to the robot, nothing there that
    could start nodes, no such launch file there.
    """
    plan = loaded.plan
    assert plan is not None
    theirs = [node.full_name for node in plan.nodes if node.machine == loaded.robot]
    address = robot_address(loaded.robot)
    request = Request(
        "begin",
        loaded.robot,
        (*name_file(words, loaded.files, loaded.world, loaded.robot), *loaded.arguments),
        choose_options(wishes),
        tuple(name for name in theirs if not _is_anonymous(name)),
        f"http://{address.host}:11311",
        address.host,
    )
    here = take_part(plan, {node.full_name for node in plan.nodes} - set(theirs))
    here = replace(here, commands=tuple(each for each in plan.commands if each.command == "dump"))
    ours = bool(here.nodes) or not wishes.detach
    try:
        answer = _ask(address, request, START_SECONDS)
    except KeyboardInterrupt:
        _end(address, request)  # it may have started
        raise
    if answer.problem:
        raise explain_problem(loaded.robot, answer.problem)
    for line in describe_part(loaded.robot, answer, len(theirs)):
        wishes.say("info", line)
    try:
        yield Part(here, address, loaded.robot, answer.run, wishes.detach)
    finally:
        if answer.run and ours:
            _end(address, request)


def name_file(words: Sequence[str], files: Sequence[str], world: World, robot: str) -> list[str]:
    """The words that name the launch file on the robot, too: a package and a file name. Raises UserError."""
    names = [word for word in words if ":=" not in word]
    path = Path(files[0])
    if len(names) >= 2 and path.name == names[1] and names[0] != "-":
        return names
    found = next((folder for folder in path.resolve().parents if (folder / "package.xml").is_file()), None)
    if found is not None and "-" not in names:
        try:
            if [Path(each).resolve() for each in world.find_files(found.name, path.name)] == [path.resolve()]:
                return [found.name, path.name, *names[1:]]
        except (LookupError, OSError, ValueError):
            pass
    raise UserError(
        error(
            f"{names[0]}: part of it runs on {robot}, expected a launch file of a package, which {robot} has too",
            rule="robot-part",
            help=f"put it into a package in ~/catkin_ws/src; then: ur sync {robot}",
        )
    )


def choose_options(wishes: Wishes) -> tuple[str, ...]:
    """The options that count for the robot's nodes as well."""
    chosen = [word for name in wishes.only for word in ("--only", name)]
    return (*chosen, *(word for name in wishes.except_ for word in ("--except", name)))


def describe_part(robot: str, answer: Answer, count: int) -> list[str]:
    """What runs on the robot, in a line or two."""
    lines = []
    if answer.running:
        others = "node runs" if len(answer.running) == 1 else "nodes run"
        lines.append(f"{robot}: {len(answer.running)} {others} already: {', '.join(answer.running)}")
    if answer.run:
        number = count - len(answer.running)
        what = f"{number} node{'' if number == 1 else 's'}, run {answer.run}"
        found = ", which ran already and is taken over" if answer.found else ""
        lines.append(f"{robot}: {what}{found}; what they print: ur shell {robot} ur attach {answer.run}")
    return lines


def explain_problem(robot: str, said: str) -> UserError:
    """What `ur launch` on the robot said when it could not start, as an error of ours."""
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    first = next((line for line in lines if line.startswith(("error", "problem"))), lines[0] if lines else said)
    help_ = next((line.removeprefix("help: ") for line in lines if line.startswith("help: ")), f"ur doctor {robot}")
    missing = ("is neither a package nor a file", "holds no file named", "is no file, expected a launch file")
    if any(each in first for each in missing):
        help_ = f"it lies in this computer's workspace? then: ur sync {robot}"
    return UserError(error(f"{robot}: {first.partition(': ')[2] or first}", rule="robot-part", help=help_))


def _ask(address: Address, request: Request, seconds: float) -> Answer:
    with connect(address) as shell:
        text = ask_part(shell, json.dumps(asdict(request)), seconds + MARGIN)
    try:
        return parse_answer(text)
    except (ValueError, TypeError):
        raise UserError(
            error(f"{address.host}: its answer cannot be read: {text[:80]!r}", rule="robot-part", help="ur boot status")
        ) from None


def _end(address: Address, request: Request) -> None:
    """End the robot's run; where that fails it goes on there, and people are told."""
    robot = request.machine
    try:
        answer = _ask(address, replace(request, action="end"), END_SECONDS)
        problem = answer.problem.removeprefix("error: ")
    except UserError as failed:
        answer, problem = Answer(), failed.diagnostics[0].message
    except KeyboardInterrupt:
        answer, problem = Answer(), "interrupted"
    if problem:
        _say(f"warning: {robot}: its nodes go on there: {problem}\n  help: ur shell {robot} ur stop --all")
    elif answer.run:
        _say(f"{robot}: {answer.run} has ended")


def _is_anonymous(name: str) -> bool:
    # Such a name has another host and process in it there: see SystemWorld.make_anonymous.
    host = os.uname().nodename.replace(".", "_").replace("-", "_")
    return f"_{host}_{os.getpid()}_" in name


@contextmanager
def _interrupted_by_signals() -> Iterator[None]:
    def interrupt(_: int, __: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = {number: signal.signal(number, interrupt) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()
