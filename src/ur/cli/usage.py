"""Messages about invalid command lines, derived from the attributes of click's exceptions."""

import os
from collections.abc import Sequence

import click

from ur.cli.verbs import VERBS, load_verb
from ur.source.printable import printable
from ur.source.suggest import did_you_mean

_ROS = """use the tool of ROS: {} (once in each shell before: eval "$(ur env)")"""
_VERBS = (
    ("topic topics rostopic echo hz pub", _ROS.format("rostopic list")),
    ("node nodes rosnode", "'ur ps' lists the runs, 'ur graph --live' draws their nodes"),
    ("service services rosservice", _ROS.format("rosservice list")),
    ("param params parameter rosparam", _ROS.format("rosparam list")),
    ("msg srv interface rosmsg rossrv", _ROS.format("rosmsg show TYPE")),
    ("bag rosbag record play", _ROS.format("rosbag record TOPIC")),
    ("pkg rospack", _ROS.format("rospack find PACKAGE")),
    ("tf action", _ROS.format("rostopic echo /tf")),
    ("daemon lifecycle component", "there is none in ROS 1; 'ur ps' lists the runs"),
    ("roslaunch rosrun", "start a launch file: ur launch PACKAGE FILE"),
    ("roscore rosmaster master core", "each run starts a master if there is none: ur run PROGRAM"),
    ("rosdep apt install add download", "install what launch files need: ur get --missing FOLDER"),
    ("build catkin catkin_make colcon make compile", "build it with catkin_make, on a robot in 'ur shell ROBOT'"),
    ("roswtf wtf diagnose", "find what is wrong: ur doctor"),
    ("rqt rqt_graph rosgraph", "draw what runs: ur graph --live"),
    ("rviz rviz2 view viz", "show the robot: ur run rviz_robot, or ur web"),
    ("start exec", "start a program: ur run PROGRAM; 'ur list' lists the programs"),
    ("kill end quit exit down", "end a run: ur stop"),
    ("status top htop running runs jobs", "list the runs: ur ps"),
    ("log tail journal output", "print what a node has printed: ur logs NODE"),
    ("update upgrade self-update pull fetch", "to update a clone: git pull; a wheel: pipx upgrade ubiquity-launches"),
    ("remove uninstall purge", "docs/how-to/uninstall.md has the steps"),
    ("push commit checkout diff", "that is a command of git"),
    ("clone search", "find a package: ur get PACKAGE"),
    ("rename hostname", "rename a robot: ur robot rename NAME NEW"),
    ("world worlds", "make a world: ur new world NAME; choose one: ur run PROGRAM world:=office"),
    ("map", "did you mean 'ur maps'?"),
    ("base bases", "make a base: ur new base NAME; choose one: ur use sim:NAME"),
    ("create init generate", "write a file that starts something: ur new"),
    ("lint validate verify", "did you mean 'ur check'?"),
    ("fmt", "did you mean 'ur format'?"),
    ("ssh login connect", "open a shell on a robot: ur shell ROBOT; select one: ur use ROBOT"),
    ("scp rsync copy cp", "synchronise the workspaces: ur sync ROBOT"),
    ("select switch", "select a robot: ur use ROBOT"),
    ("discover scan ping", "list the robots on the network: ur robots"),
    ("page browser gui ui dashboard", "did you mean 'ur web'?"),
    ("sim simulate simulator gazebo stage", "select a simulated robot: ur use sim; then: ur run PROGRAM"),
    ("drive teleop keyboard", "did you mean 'ur run keyboard_drive'?"),
    ("navigate goto go goal nav", "did you mean 'ur run keyboard_navigate'?"),
    ("slam mapping", "did you mean 'ur run make_map'?"),
    ("explore", "did you mean 'ur run make_map explore:=true'?"),
    ("camera image_view", "did you mean 'ur run raspicam_view'?"),
    ("config settings", "show what is selected: ur use; set this computer up: ur setup"),
    ("version", "did you mean 'ur --version'?"),
    ("test", "check launch files: ur check; the project's own tests: ./test"),
)  # fmt: skip
_REMOVED = {"ur docs --site": "write the page with '--output FILE.md'; MkDocs and others make a site of Markdown"}
_MAPS = (
    ("join combine concat fuse append", "merge"),
    ("rm remove del erase", "delete"),
    ("mv move name", "rename"),
    ("cp get put pull push send fetch", "copy"),
    ("save write", "export"),
    ("load add open", "import"),
    ("view draw print cat", "show"),
    ("crop change turn", "edit"),
)


def describe_usage_error(problem: click.UsageError, argv: Sequence[str]) -> str:
    """Return one line with the mistake of a command line, and one with help. `argv` are the arguments after `ur`.

    Arguments are untrusted text: the shell may derive them from file names.
    """
    message, help_line = _describe(problem, argv)
    return f"error: {printable(message)}\n  help: {printable(help_line)}"


def _describe(problem: click.UsageError, argv: Sequence[str]) -> tuple[str, str]:
    context = problem.ctx
    where = context.command_path if context is not None and context.parent is not None else "ur"
    if context is None and argv[0] in VERBS:  # click does not report an option without its value
        command = load_verb(argv[0])
        inner = getattr(command, "commands", {})
        name = next((word for word in argv[1:] if word in inner), "")
        where = f"ur {argv[0]} {name}".rstrip()
    help_line = f"'{where} --help' lists the options"
    if isinstance(problem, click.NoSuchOption):
        message = f"{where}: unknown option '{problem.option_name}'"
        names = [name for param in context.command.params for name in param.opts] if context else []
        near = _suggest_argument(problem.option_name, argv) or did_you_mean(problem.option_name, names)
        help_line = f"did you mean {near!r}?" if near else help_line
        plain = problem.option_name.lstrip("-").replace("-", "_")
        if context and any(
            param.name == plain and isinstance(param, click.Argument) for param in context.command.params
        ):
            usage = " ".join(context.command.collect_usage_pieces(context))
            help_line = f"give it without {problem.option_name}: {where} {usage}"
        if instead := _REMOVED.get(f"{where} {problem.option_name}"):
            message, help_line = f"{where}: option '{problem.option_name}' was removed", instead
    elif isinstance(problem, click.BadOptionUsage):
        message = f"{where}: option '{problem.option_name}' requires a value"
    elif isinstance(problem, click.exceptions.NoSuchCommand):
        return _describe_unknown_command(problem, where)
    elif (
        isinstance(problem, click.BadParameter)
        and not isinstance(problem, click.MissingParameter)
        and (wanted := describe_values(problem.param))
    ):
        message = f"{where}: {_describe_value(problem, argv)}, expected {wanted}"
    else:
        message = problem.format_message().rstrip(".")
        message = f"{where}: {message[:1].lower()}{message[1:]}"
        if where == "ur run" and isinstance(problem, click.MissingParameter):
            help_line = "'ur list' lists the programs"
    return message, help_line


def _suggest_argument(option: str, argv: Sequence[str]) -> str:
    """Return the launch argument that was written as an option of `ur launch`: 'world:=office'; '' if none was."""
    if argv[:1] != ["launch"]:
        return ""
    from ur.launchfile.address import resolve_addresses
    from ur.request.launch_request import LaunchFiles, suggest_assignment
    from ur.request.plan_files import make_world
    from ur.source.diagnostic import UserError

    place = next((index for index, word in enumerate(argv) if word.partition("=")[0] == option), len(argv))
    world = make_world()
    try:
        declared = LaunchFiles(resolve_addresses(argv[1:place], world), world).declared
    except UserError:
        return ""
    following = "".join(argv[place + 1 : place + 2])
    text = argv[place] if place < len(argv) else option
    return suggest_assignment(text, declared, "" if following.startswith("-") else following)


def _describe_unknown_command(problem: click.exceptions.NoSuchCommand, where: str) -> tuple[str, str]:
    name = problem.command_name
    if where == "ur":
        help_line = _suggest_command(name) or "'ur --help' lists the commands"
        return f"unknown command {name!r}", help_line
    near = did_you_mean(name, getattr(problem.ctx.command, "commands", ()) if problem.ctx else ())
    help_line = suggest_for(where, name) or (
        f"did you mean '{where} {near}'?" if near else f"'{where} --help' lists the commands"
    )
    return f"unknown command {f'{where} {name}'!r}", help_line


def _describe_value(problem: click.BadParameter, argv: Sequence[str]) -> str:
    """Describe the value that a parameter refuses, as typed: 'invalid value '0' for --port'."""
    param, context = problem.param, problem.ctx
    assert param is not None
    target = f" for {max(param.opts, key=len)}" if isinstance(param, click.Option) else ""
    typed = _find_refused(param, context, argv) if context is not None else None
    return f"invalid value{'' if typed is None else f' {typed!r}'}{target}"


def _find_refused(param: click.Parameter, context: click.Context, argv: Sequence[str]) -> str | None:
    # click's exception does not contain the value, so the command's own parser reads the arguments again.
    rest = list(argv)
    for name in context.command_path.split()[1:]:
        rest = rest[rest.index(name) + 1 :]
    options, _, _ = context.command.make_parser(context).parse_args(rest)
    given = options.get(param.name or "")
    values = given if isinstance(given, (list, tuple)) else [] if given is None else [given]
    return next((str(value) for value in values if not _accepts(param, value, context)), None)


def _accepts(param: click.Parameter, value: object, context: click.Context) -> bool:
    try:
        param.type.convert(value, param, context)
    except click.BadParameter:
        return False
    return True


def _suggest_command(word: str) -> str | None:
    # A launch file or a program alone: the verb was left out.
    if word.endswith((".launch", ".launch.xml")):
        return f"start a launch file: ur launch {word}"
    name, assigned, value = word.partition("=")
    if assigned:
        from ur.request.launch_request import write_assignment

        name = name.removesuffix(":")
        shown = name if name.isascii() and name.isidentifier() else "NAME"
        return f"arguments follow a program: ur run PROGRAM {write_assignment(shown, value)}"
    from ur.request.environment import add_own_package
    from ur.request.programs import PACKAGE, index_programs

    programs = {program.name for program in index_programs(PACKAGE, add_own_package(os.environ)).programs}
    if word not in programs and (known := suggest_for("ur", word)):
        return known
    near = did_you_mean(word, VERBS) if word not in programs else None
    if near:
        return f"did you mean 'ur {near}'?"
    near = did_you_mean(word, programs)
    return f"did you mean 'ur run {near}'?" if near else None


def describe_values(param: click.Parameter | None) -> str:
    """Describe the values of an option: 'a whole number from 1 to 65535', 'bash, fish or zsh'; '' for any text."""
    kind = param.type if param is not None else None
    if isinstance(kind, click.Choice):
        *some, last = map(str, kind.choices)
        return f"{', '.join(some)} or {last}" if some else last
    if not isinstance(kind, click.types.IntParamType | click.types.FloatParamType):
        return ""
    text = "a whole number" if isinstance(kind, click.types.IntParamType) else "a number"
    least, most = (
        None if bound is None else f"{bound:f}".rstrip("0").rstrip(".") if bound % 1 else f"{bound:.0f}"
        for bound in (getattr(kind, "min", None), getattr(kind, "max", None))
    )
    is_open = getattr(kind, "min_open", False)
    if least is None:
        return text if most is None else f"{text} up to {most}"
    if most is None:
        return f"{text} above {least}" if is_open else f"{text} from {least} up"
    return f"{text} above {least}, up to {most}" if is_open else f"{text} from {least} to {most}"


def suggest_for(where: str, word: str) -> str | None:
    """Return a help line for an argument of other tools after `where` (`ur`, `ur maps`); None for other arguments."""
    if where == "ur maps":
        if word in ("list", "ls"):
            return "'ur maps' alone lists the maps"
        verb = _find(_MAPS, word)
        return verb and f"did you mean 'ur maps {verb}'?"
    return _find(_VERBS, word) if where == "ur" else None


def _find(table: tuple[tuple[str, str], ...], word: str) -> str | None:
    return next((text for words, text in table if word in words.split()), None)
