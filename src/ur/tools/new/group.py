"""Launch files that include others, m_<name>, and the program that starts one."""

from collections.abc import Iterable, Iterator, Sequence
from textwrap import fill
from xml.sax.saxutils import escape, quoteattr

from ur.tools.new.parts import IncludedPart, NewArgument, NewFile

_WIDTH = 118
LOCALHOST = (
    "<!-- roslaunch knows no machine by itself, not even this one; saying it twice does no harm. -->",
    '<machine name="localhost" address="localhost"/>',
)
MACHINE = NewArgument("machine", "Where the node runs.", default="localhost")


def write_launch(summary: str, overview: str, arguments: Sequence[NewArgument], body: Iterable[str]) -> str:
    """Return a launch file: Summary, Overview, arguments by kind with documentation, and the lines of the rest."""
    lines = ["<launch>", f"  <!--Summary: {as_comment(summary)}-->"]
    paragraph = fill(as_comment(overview), _WIDTH - 4, break_long_words=False, break_on_hyphens=False)
    lines += ["  <!--Overview:", *(f"    {line}" for line in paragraph.splitlines()), "  -->"]
    for title, kind in (("Required", "required"), ("Convenience", "value"), ("Optional", "default")):
        chosen = [each for each in arguments if _kind(each) == kind]
        if chosen:
            lines += [
                "",
                f"  <!-- {title} arguments -->",
                *(f"  {line}" for each in chosen for line in _argument(each)),
            ]
    lines += ["", *(f"  {line}" for line in body), "</launch>", ""]
    return "\n".join(lines)


def attribute(name: str, value: str) -> str:
    """Return `name="value"`, escaped."""
    return f"{name}={quoteattr(value)}"


def as_comment(text: str) -> str:
    """Return a text as valid content of a comment: in one line, without two dashes in a row."""
    words = " ".join(text.split())
    while "--" in words:
        words = words.replace("--", "-")
    return words.removesuffix("-")


def hand_on(names: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Yield the `<arg>` tags of an include, which pass on arguments (theirs, ours)."""
    yield from (f'  <arg name="{theirs}" value="$(arg {ours})"/>' for theirs, ours in names)


def _kind(argument: NewArgument) -> str:
    if argument.value is not None:
        return "value"
    return "required" if argument.default is None else "default"


def _argument(argument: NewArgument) -> Iterator[str]:
    given = ""
    if argument.value is not None:
        given = " " + attribute("value", argument.value)
    elif argument.default is not None:
        given = " " + attribute("default", argument.default)
    yield f'<arg name="{escape(argument.name)}"{given}/>'
    yield f"<!--{argument.name}: {as_comment(argument.doc)}-->"


_MACHINES = {
    "robot_machine": NewArgument(
        "robot_machine", "The robot: where everything runs that drives or senses.", default="localhost"
    ),
    "viewer_machine": NewArgument("viewer_machine", "The viewer: where people watch and steer.", default="localhost"),
}
_STANDARD = {
    "robot_base": NewArgument("robot_base", "The base, for example `stage` or `magni`."),
    "robot_variant": NewArgument("robot_variant", "The variant of the base; empty for the plain base.", default=""),
    "simulate": NewArgument(
        "simulate", "`true`: the simulator stands for the robot; `false`: its own driver does.", default="true"
    ),
    "world": NewArgument("world", "The simulated world.", default="maze"),
    **_MACHINES,
}


def plan_multi(name: str, summary: str, parts: Sequence[IncludedPart]) -> tuple[NewFile, ...]:
    """Plan a launch file that includes others; their required arguments that no other file sets become its own."""
    arguments: dict[str, NewArgument] = {}
    body: list[str] = []
    for part in parts:
        handed = list(_handed(part, arguments))
        body += (
            [f'<include file="{part.file}">', *hand_on(handed), "</include>"]
            if handed
            else [f'<include file="{part.file}"/>']
        )
    folder = f"m_{name}"
    started = ", ".join(f"`{_stem(part.file)}`" for part in parts)
    text = write_launch(summary, f"It starts {started}.", list(arguments.values()), body)
    return (NewFile(f"{folder}/launch/{folder}.launch.xml", text),)


def _stem(file: str) -> str:
    return file.rpartition("/")[2].removesuffix(".xml").removesuffix(".launch")


def _handed(part: IncludedPart, arguments: dict[str, NewArgument]) -> Iterator[tuple[str, str]]:
    viewer = part.file.rpartition("/")[2].startswith(
        ("rviz_", "n_rviz", "n_teleop_twist_keyboard", "n_keyboard", "n_joy.")
    )
    for theirs, default in part.arguments.items():
        ours = ("viewer_machine" if viewer else "robot_machine") if theirs == "machine" else theirs
        if ours in _STANDARD:
            arguments.setdefault(ours, _STANDARD[ours])
        elif default is None:
            arguments.setdefault(
                ours, NewArgument(ours, part.docs.get(theirs) or f"As {part.file.rpartition('/')[2]} has it.")
            )
        else:
            continue
        yield theirs, ours


def plan_program(name: str, summary: str, package: str, launch: str) -> tuple[NewFile, ...]:
    """Plan a program in `bin` that starts a launch file of its package."""
    text = "\n".join(
        [
            "#!/bin/bash",
            f"##Summary: {' '.join(summary.split())}",
            f"##Overview: Starts `{launch}` on the selected robot.",
            "##",
            f"## Arguments are those of `{launch}`, written `NAME:=VALUE`.",
            f'exec ur launch {package} {launch} "$@"',
            "",
        ]
    )
    return (NewFile(f"bin/ur_{name}", text, executable=True),)
