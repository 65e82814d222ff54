"""The command that `ur boot install` writes: of a launch file, a program, or a command."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ur.request.environment import add_own_package
from ur.robot.boot.launch_file import RobotLaunch, choose_arguments, find_launch, is_launch_name
from ur.robot.boot.units import (
    FOLDER,
    GUARD,
    LIBRARIES,
    MASTER,
    PREFIX,
    UnitFile,
    command_line,
    guard_units,
    is_unit_name,
    launch_line,
    master_unit,
    page_line,
    program_unit,
    source_line,
)
from ur.robot.deploy.repository import read_repository
from ur.robot.robot_file import ROBOT_FILE, Ros2Robot
from ur.robot.setup.change import Change
from ur.robot.setup.engine import apply_states
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.packages import WantedService
from ur.robot.setup.wanted import Wanted, WantedFile
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import Shell, quote
from ur.source.arguments import Argument, split_argv, values_of
from ur.source.diagnostic import UserError, user_error
from ur.source.project import LIBRARY, launch_library

PAGE = "web"
"""The name of the page among programs."""

_PREPARE_LIMIT = 900.0  # s for a download over a slow network


@dataclass(frozen=True, slots=True)
class BootRequest:
    """A launch file of a package with arguments, or, with an empty `package`, the argv of a command.

    `name` is the default name of the service. `page`: the service is `ur web`, which has neither.
    """

    name: str
    package: str
    file: str
    argv: tuple[str, ...]
    page: bool = False


def parse_request(argv: Sequence[str]) -> BootRequest:
    """Parse one of the four forms. Raises UserError for a program without a launch file, or a page with arguments."""
    first, rest = argv[0], tuple(argv[1:])
    if first == PAGE:
        if rest:
            raise _problem(f"{rest[0]!r} is unexpected: the page takes no arguments", "ur boot install web")
        return BootRequest(PAGE, "", "", (), page=True)
    if rest and is_launch_name(rest[0]):
        return BootRequest(rest[0].partition(".")[0].lower(), first, rest[0], rest[1:])
    program = first.removeprefix("ur_")
    if "/" not in first and (launch_library() / "bin" / f"ur_{program}").is_file():
        from ur.request.programs import choose_program, find_launch_file, list_programs

        path = find_launch_file(choose_program(list_programs(launch_library() / "bin", LIBRARY), program))
        if path is not None:
            return BootRequest(program, LIBRARY, path.name, rest)
    return BootRequest(first.rpartition("/")[2].lower(), "", "", tuple(argv))


def make_line(request: BootRequest, shell: Shell, robot: str, ros2: Ros2Robot | None = None) -> str:
    """Return the command line of the service.

    Raises UserError if the file is not on the robot, an argument is wrong, or a terminal is needed.
    """
    setting = source_line(ros2, robot) if ros2 else ""
    line = _make_line(request, shell, robot, ros2, setting)
    return f"{setting}; {line}" if setting else line


def _make_line(request: BootRequest, shell: Shell, robot: str, ros2: Ros2Robot | None, setting: str) -> str:
    if request.page:
        return page_line("--service")
    if not request.package:
        found = shell.run(quote("bash", "-lc", f"{setting or ':'}; command -v {quote(request.argv[0])}"))
        if found.code:
            raise _problem(
                f"{robot}: {request.argv[0]!r} is no command there, expected PACKAGE FILE.launch, PROGRAM or a command",
                "'ur list' names the programs",
            )
        return command_line(request.argv)
    launch = find_launch(shell, request.package, request.file, robot, setting)
    stray, given = split_argv(request.argv)
    if stray:
        message = f"{stray[0]!r} is not an argument of {request.file}, expected NAME:=VALUE"
        raise _problem(message, "ur boot install --help")
    more = ros2.arguments() if ros2 else {}
    values = choose_arguments(_declared(launch), values_of(given), _facts(launch), request.file, more)
    arguments = [str(Argument(name, value)) for name, value in values.items()]
    _refuse_terminal(request, arguments)
    return launch_line(request.package, request.file, arguments, roslaunch=ros2 is None)


def bring_library(request: BootRequest, shell: SshShell, user: str, report: Callable[[Change], None]) -> int:
    """Copy this project to the robot if one of its launch files is requested; return the number of changes.

    `report` is called with each change. Raises UserError if it is not set up on the robot, so that its nodes could not
    run.
    """
    if request.package != LIBRARY and not request.page:
        return 0
    wanted = read_repository()
    _, count = apply_states(shell, lambda _: [wanted], user, FactsRequest(user), root=False, report=report)
    if shell.run(f"for d in {' '.join(LIBRARIES)}; do [ -r $d/.venv/ready-run ] && exit; done; exit 1").code:
        raise _problem(
            f"{shell.address.host}: {LIBRARY} is there and not set up, and its nodes need that",
            f"ur robot setup {shell.address.host.removesuffix('.local')} completes it; then run this again",
        )
    if request.page:
        done = shell.run(quote("bash", "-lc", page_line("--prepare")), timeout=_PREPARE_LIMIT)
        if done.code:
            reason = done.err.strip().splitlines() or [f"exit code {done.code}"]
            reported = next((line for line in reason if line.startswith("error: ")), reason[-1]).removeprefix("error: ")
            help_ = f"connect it to the internet, once: ur robot wifi {shell.address.host.removesuffix('.local')}"
            raise _problem(f"{shell.address.host}: what the page needs is not installed there: {reported}", help_)
    return count


def _declared(launch: RobotLaunch) -> dict[str, bool]:
    from ur.launchfile.syntax.parse import parse_launch_file

    parsed = parse_launch_file(launch.path, launch.data)
    if parsed.launch is None:
        raise UserError(*parsed.diagnostics)
    return {
        element.attributes.get("name", ""): "default" not in element.attributes
        for element in parsed.launch.elements
        if element.name == "arg" and "value" not in element.attributes
    }


def _facts(launch: RobotLaunch) -> dict[str, str]:
    from ur.source.file import SourceFile
    from ur.source.section import parse_section

    try:
        top = parse_section(SourceFile(str(ROBOT_FILE), launch.robot_file), "a robot file")
        return {key: top.text(key, "") for key in ("base", "variant")}
    except UserError:
        return {}


def _refuse_terminal(request: BootRequest, arguments: Sequence[str]) -> None:
    """Refuse programs that need a terminal, if this computer has the file: a booting robot has none."""
    from ur.launchfile.address import resolve_addresses
    from ur.launchfile.load import load_plan
    from ur.launchfile.world.system import SystemWorld

    world = SystemWorld(add_own_package(os.environ))
    try:
        plan = load_plan(resolve_addresses([request.package, request.file], world), [*arguments], world)
    except (UserError, LookupError, OSError):
        return
    wanting = [node.full_name for node in plan.nodes if node.terminal]
    if wanting:
        raise _problem(
            f"{request.file}: {wanting[0]} needs the terminal, which a robot that boots does not have",
            "the robot can start its own part: ur boot install robot_base",
        )


def _problem(message: str, help: str) -> UserError:
    return user_error(message, rule="no-boot-service", help=help)


def check_name(name: str, help: str, *, master: bool = False) -> None:
    """Raise UserError, with the advice `help`, for an invalid name of a boot service; `master` permits that name."""
    if not is_unit_name(name) and not (master and name == MASTER):
        message = f"{name!r} is not a name for a boot service, expected lower case letters, digits, - and _"
        raise user_error(message, rule="bad-name", help=help)


def has_service(shell: Shell, name: str) -> bool:
    """Return whether a robot has a boot service of this name."""
    return not shell.run(quote("[", "-e", f"{FOLDER}/{PREFIX}{name}.service", "]")).code


def install_services(
    shell: Shell, user: str, name: str, line: str, report: Callable[[Change], None], *, master: bool = True
) -> int:
    """Install the master's service, and that of a command line unless it is ""; return the number of changes.

    With a command line come the units that guard the motors of its drivers. On ROS 2 there is no master. `report` is
    called with each change. The shell has to be root's, or has found how to use sudo. Raises UserError.
    """

    def make(facts: ComputerFacts) -> list[Wanted]:
        units = [master_unit(user, facts.home)] if master else []
        wanted: list[Wanted] = []
        if line:
            units.append(program_unit(name, line, user, facts.home, master=master))
            then = f"systemctl daemon-reload; systemctl try-restart {GUARD}.socket"
            guards = guard_units(user, facts.home)
            wanted += [WantedFile(GUARD, path, text, then=then) for path, text in guards.items()]
            wanted.append(WantedService(f"{GUARD} listens", f"{GUARD}.socket"))
        return wanted + [item for unit in units for item in _want(unit)]

    _, count = apply_states(shell, make, user, FactsRequest(user), root=True, report=report)
    return count


def remove_services(shell: Shell, names: Sequence[str]) -> tuple[list[str], bool]:
    """Stop and remove services, without names all; return a line for each removed one, and whether that succeeded."""
    patterns = " ".join(f"{FOLDER}/{PREFIX}{name}.service" for name in names or ["*"])
    script = (
        f'for f in {patterns}; do [ -e "$f" ] || continue; u=${{f##*/}}; '
        'systemctl disable --now "$u" 2>&1; rm -f "$f"; echo "$u: removed"; done; '
        f"ls {FOLDER}/{PREFIX}*.service >/dev/null 2>&1 || {{ systemctl disable --now {GUARD}.socket 2>&1; "
        f"rm -f {FOLDER}/{GUARD}.socket {FOLDER}/{GUARD}@.service; }}; systemctl daemon-reload"
    )
    done = shell.run(script, root=True)
    return [line for line in done.out.splitlines() if line.endswith(": removed")], done.code == 0


def _want(unit: UnitFile) -> list[Wanted]:
    service = f"{unit.service}.service"
    return [
        WantedFile(
            unit.service, unit.path, unit.text, then=f"systemctl daemon-reload; systemctl try-restart {service}"
        ),
        WantedService(f"{unit.service} runs", service),
    ]
