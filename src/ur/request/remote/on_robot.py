"""A program on two computers: the robot's nodes in a detached run on the robot, the others on this computer."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType

from ur.launchfile.plan.specs import Plan
from ur.request.environment import current_selection
from ur.request.launch_request import LaunchOptions, LaunchRequest, Report
from ur.request.plan_files import LoadedPlan, texts
from ur.request.remote.connection import robot_address
from ur.request.remote.share_again import LinkReporter, ShareAgain, examine_robot
from ur.robot.discovery.record import load_records, records_folder
from ur.robot.remote_run import ask_part
from ur.robot.ssh.address import Address
from ur.robot.ssh.openssh import STRICT, connect
from ur.robot.ssh.shell import quote
from ur.run.record.registry import describe_user, read_computer
from ur.run.remote.names import describe_names, rename_nodes
from ur.run.remote.own_clients import clients_folder, list_clients
from ur.run.remote.protocol import Client, Problem, ShareAnswer, ShareRequest, dump, parse_answer
from ur.run.remote.share import END_SECONDS
from ur.run.remote.start import START_SECONDS
from ur.run.startup.node_selection import keep_nodes
from ur.source.diagnostic import UserError, user_error_about

AGAIN_SECONDS = 0.5
MARGIN = 30.0  # s more than what the robot itself waits for: login and network
_ALIVE = ("-o", "BatchMode=yes", "-o", "ServerAliveInterval=1", "-o", "ServerAliveCountMax=3")
_WITH_US = ("setpriv", "--pdeathsig", "TERM", "--")  # it ends when this process does, killed or not


@dataclass(frozen=True, slots=True)
class SharedProgram:
    """A program whose robot's nodes run on the robot, and the other ones (`here`) on this computer.

    `run` is the id of the robot's run, '' for none; `client` is the id of this run among those that use the robot's.
    """

    here: Plan
    address: Address
    robot: str
    run: str
    detached: bool
    client: str
    again: ShareAgain

    def follow(self) -> int:
        """Print the output of the robot's run until it ends or this process is to end; return the exit code.

        A broken connection is re-established, while the run continues. A detached run is not followed.
        """
        if self.detached or not self.run:
            return 0
        with _interrupted_by_signals(), LinkReporter(self.robot, self.address.host, _print) as link:
            try:
                return self._follow(link)
            except KeyboardInterrupt:
                return 0

    def _follow(self, link: LinkReporter) -> int:
        run, lost = self.run, False
        while True:
            code = self._show(run)
            if code == 255:
                if not lost:
                    _print(f"{self.robot}: connection lost; {run} keeps running on the robot; retrying")
                lost = True
                link.wait_reachable(AGAIN_SECONDS)
                continue
            if not (lost and code and self.again.has_restarted()):
                return code
            _print(f"{self.robot} has restarted: its nodes are started again")
            if problem := self.again.start():
                _print(f"error: {problem}")
                return 1
            if not self.again.run:
                return 0  # they start with the robot, and are not of this run
            run, lost = self.again.run, False

    def _show(self, run: str) -> int:
        # The robot knows by this variable that this client still runs: see ur.run.remote.signs.
        line = quote("bash", "-lc", f"UR_CLIENT={quote(self.client)} exec ur attach --plain {quote(run)}")
        sys.stdout.flush()
        process = subprocess.Popen(
            [*_WITH_US, "ssh", *STRICT, *_ALIVE, "--", str(self.address), line],
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )
        try:
            return process.wait()
        finally:
            if process.poll() is None:
                process.terminate()
                process.wait()


@contextmanager
def start_there(loaded: LoadedPlan, client: str, report: Report) -> Iterator[SharedProgram]:
    """Start the robot's nodes on the robot, or find them running; unregister from them with the context.

    They end when no other computer uses them. A detached run without a node on this computer continues. `client` is the
    id of this run. Raises UserError if the robot cannot be reached, has no installation that could start nodes, or
    lacks the launch file.
    """
    plan, launch = loaded.plan, loaded.request
    assert plan is not None
    was_known = loaded.robot in _list_known()
    theirs = [node.full_name for node in plan.nodes if node.machine == loaded.robot]
    address = robot_address(loaded.robot)
    here = keep_nodes(plan, {node.full_name for node in plan.nodes} - set(theirs))
    here = here._replace(commands=tuple(each for each in plan.commands if each.command == "dump"))
    ours = bool(here.nodes) or not launch.options.detach
    names = tuple(node.full_name for node in here.nodes if not _is_anonymous(node.full_name))
    request = ShareRequest(
        "begin",
        loaded.robot,
        (*name_file(launch, loaded.robot), *texts(loaded.arguments)),
        choose_options(launch.options),
        tuple(name for name in theirs if not _is_anonymous(name)),
        f"http://{address.host}:11311",
        address.host,
        describe_client(client, names, detached=not ours),
    )
    try:
        answer = _ask(address, request, START_SECONDS)
    except KeyboardInterrupt:
        _end(address, request, loaded.robot)  # it may have started
        raise
    if answer.problem:
        raise explain_problem(loaded.robot, answer.problem)
    for line in describe_part(loaded.robot, answer, len(theirs)):
        report("info", line)
    for line in describe_names(answer.names):
        report("info", line)
    here = rename_nodes(here, answer.names)
    final = tuple(answer.names.get(name, name) for name in names)
    request = replace(request, client=describe_client(client, final, detached=not ours))
    again = _make_again(address, request, launch.argv)
    try:
        yield SharedProgram(here, address, loaded.robot, answer.run, launch.options.detach, client, again)
    finally:
        again.close()
        if ours and (answer.run or answer.running):
            _end(address, request, find_new_name(loaded.robot) if was_known else loaded.robot)


def describe_client(client: str, nodes: tuple[str, ...], *, detached: bool) -> Client:
    """Return this run as a client of the robot's."""
    computer = read_computer()
    name = computer.host.partition(".")[0]
    return Client(client, name, describe_user(computer, os.getuid()), os.getpid(), nodes, detached)


def _make_again(address: Address, request: ShareRequest, argv: Sequence[str]) -> ShareAgain:
    """Return the object that starts the robot's run again after a restart of the robot."""

    def begin() -> tuple[str, str]:
        answer = _ask(address, request, START_SECONDS)
        if answer.problem:
            return "", explain_problem(request.machine, answer.problem).diagnostics[0].message
        return answer.run, ""

    began = time.clock_gettime(time.CLOCK_BOOTTIME)
    return ShareAgain(
        request.machine,
        lambda: examine_robot(address),
        begin,
        lambda: time.clock_gettime(time.CLOCK_BOOTTIME) - began,
        quote("ur", "launch", *argv),
    )


def name_file(request: LaunchRequest, robot: str) -> list[str]:
    """Return names of the launch file that are also valid on the robot: a package and a file name. Raises UserError."""
    names, world = list(request.names), request.files.world
    path = Path(request.files.paths[0])
    if len(names) >= 2 and path.name == names[1] and names[0] != "-":
        return names
    found = next((folder for folder in path.resolve().parents if (folder / "package.xml").is_file()), None)
    if found is not None and "-" not in names:
        try:
            if [Path(each).resolve() for each in world.find_files(found.name, path.name)] == [path.resolve()]:
                return [found.name, path.name, *names[1:]]
        except (LookupError, OSError, ValueError):
            pass
    raise user_error_about(
        names[0],
        f"part of it runs on {robot}, expected a launch file of a package, which {robot} has too",
        rule="robot-part",
        help=f"put it into a package in ~/catkin_ws/src; then: ur sync {robot}",
    )


def choose_options(options: LaunchOptions) -> tuple[str, ...]:
    """Return the options that also apply to the robot's nodes."""
    chosen = [each for name in options.only for each in ("--only", name)]
    return (*chosen, *(each for name in options.except_ for each in ("--except", name)))


def find_new_name(robot: str) -> str:
    """Return the present name of a robot, which may have been renamed from this computer since."""
    selected = current_selection(os.environ)
    known = _list_known()
    return selected.robot if robot not in known and selected.robot in known else robot


def _list_known() -> set[str]:
    return {record.name for record in load_records(records_folder(os.environ))}


def _ask(address: Address, request: ShareRequest, seconds: float) -> ShareAnswer:
    alive = tuple(list_clients(clients_folder(os.environ, os.getuid())))
    with connect(address) as shell:
        text = ask_part(shell, dump(replace(request, alive=alive)), seconds + MARGIN)
    try:
        return parse_answer(text)
    except (ValueError, TypeError):
        raise user_error_about(
            address.host, f"its answer cannot be read: {text[:80]!r}", rule="robot-part", help="ur boot status"
        ) from None


def _end(address: Address, request: ShareRequest, robot: str) -> None:
    """Unregister from the robot's run; if that fails it keeps running, which is reported.

    `robot` is its present name.
    """
    if robot != request.machine:
        address = replace(address, host=f"{robot}.local")
    try:
        answer = _ask(address, replace(request, action="end"), END_SECONDS)
        problem = answer.problem.message if answer.problem else ""
    except UserError as failed:
        answer, problem = ShareAnswer(), failed.diagnostics[0].reason or failed.diagnostics[0].message
    except KeyboardInterrupt:
        answer, problem = ShareAnswer(), "interrupted"
    for line in describe_end(robot, answer):
        _print(line)
    if problem:
        _print(f"warning: {robot}: its nodes go on there: {problem}\n  help: ur shell {robot} ur stop --all")


def _is_anonymous(name: str) -> bool:
    # There, such a name contains another host and process: see SystemWorld.make_anonymous.
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


def _print(text: str) -> None:
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


# Of the command line: the launch file does not exist on the robot
_MISSING = frozenset({"missing-file", "unknown-package"})


def describe_part(robot: str, answer: ShareAnswer, count: int) -> list[str]:
    """Describe the nodes that run on the robot, in a line or two."""
    lines = []
    if answer.renamed_from:
        lines.append(f"{robot}: its nodes ran under its old name {answer.renamed_from} and are started again")
    if answer.running:
        others = "node runs" if len(answer.running) == 1 else "nodes run"
        lines.append(f"{robot}: {len(answer.running)} {others} already: {', '.join(answer.running)}")
    if answer.run:
        number = count - len(answer.running)
        what = f"{number} node{'' if number == 1 else 's'}, run {answer.run}"
        found = f", {_explain_found(answer.clients)}" if answer.found else ""
        lines.append(f"{robot}: {what}{found}; what they print: ur shell {robot} ur attach {answer.run}")
    if answer.clients and not answer.found:
        lines.append(f"{robot}: {', '.join(answer.clients)} {_use(answer.clients)} these nodes too")
    return lines


def describe_end(robot: str, answer: ShareAnswer) -> list[str]:
    """Describe the state of the robot's nodes after this run has unregistered from them."""
    lines = [f"{robot}: {run} has ended" for run in answer.ended]
    return [*lines, *(f"{robot}: {run} goes on for {', '.join(answer.clients)}" for run in answer.kept)]


def explain_problem(robot: str, problem: Problem) -> UserError:
    """Convert a problem of the robot to an error of this computer."""
    help_ = problem.help or f"ur doctor {robot}"
    if problem.rule in _MISSING and not problem.place:
        help_ = f"is it in the workspace of this computer? then: ur sync {robot}"
    place = f"{problem.place}: " if problem.place else ""
    return user_error_about(robot, f"{place}{problem.message}", rule=problem.rule or "robot-part", help=help_)


def _explain_found(clients: Sequence[str]) -> str:
    return f"which {', '.join(clients)} {_use(clients)} too" if clients else "which ran already and is taken over"


def _use(names: Sequence[str]) -> str:
    return "uses" if len(names) == 1 else "use"
