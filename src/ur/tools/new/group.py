"""Launch files that include others, m_<name>, and the program that starts one."""

from collections.abc import Iterator, Sequence

from ur.tools.new.launch_text import hand_on, write_launch
from ur.tools.new.parts import IncludedPart, NewArgument, NewFile

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
