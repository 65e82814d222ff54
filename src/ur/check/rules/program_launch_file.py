"""A program starts a launch file that is not there, or gives it an argument that it does not know."""

from __future__ import annotations

import re
from collections.abc import Iterable

from ur.check.example_parts import PROGRAM_HEAD, make_talk_launch
from ur.check.model import Example, Found, Group, LaunchView, ProgramView, Rule
from ur.source.diagnostic import Severity
from ur.source.file import Span
from ur.source.suggest import did_you_mean

_COMMAND = re.compile(r"^[^#\n]*\blaunch\b(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE)
_FILE = re.compile(r"(?<![\w.*$}])(?:[\w./-]*/)?(\w+\.launch(?:\.xml)?)(?![\w.])")
_ARGUMENT = re.compile(r"(?<![\w$])(\w+):=")


def _find_wrong_launches(view: ProgramView) -> Iterable[Found]:
    by_name = {path.rpartition("/")[2]: launch for path, launch in view.launch_files.items()}
    if not by_name:
        return
    for command in _COMMAND.finditer(view.source.text.replace("roslaunch", "   launch")):
        file = _FILE.search(command.group())
        if file is None or not _is_ours(command.group(), file, view):
            continue
        span = Span(view.source, command.start() + file.start(1), command.start() + file.end(1))
        launch = by_name.get(file.group(1))
        if launch is None:
            near = did_you_mean(file.group(1), by_name)
            message = f"{view.package.name} has no launch file {file.group(1)}, expected one"
            yield Found(span, message, f"did you mean {near}?" if near else "check the name")
        else:
            yield from _check_arguments(command, launch, view)


def _is_ours(command: str, file: re.Match[str], view: ProgramView) -> bool:
    words = command[: file.start()].split()
    return bool(words) and words[-1].strip("\"'") == view.package.name


def _check_arguments(command: re.Match[str], launch: LaunchView, view: ProgramView) -> Iterable[Found]:
    for argument in _ARGUMENT.finditer(command.group()):
        name = argument.group(1)
        if name not in launch.declared and not name.startswith("_"):
            near = did_you_mean(name, launch.declared)
            known = ", ".join(sorted(launch.declared)) or "none"
            yield Found(
                Span(view.source, command.start() + argument.start(1), command.start() + argument.end(1)),
                f"argument '{name}' is given, but {launch.path} does not declare it",
                f"did you mean {near}?" if near else f"declared: {known}",
            )


def _example(command: str) -> Example:
    launch = make_talk_launch('<arg name="word" default="hello"/>', "<!--word: What is said.-->", says="$(arg word)")
    return Example({"bin/ur_talk": PROGRAM_HEAD + command, "n_talker/launch/n_talker.launch": launch})


RULE = Rule(
    id="program-launch-file",
    group=Group.FILES,
    severity=Severity.ERROR,
    summary="A program starts a launch file that is not there, or gives it an unknown argument.",
    explanation="""
Lines of programs in `bin` that start a launch file of their own package, with roslaunch or `ur launch`.
""",
    bad=(
        _example('exec roslaunch my_robot «n_talkr.launch» "$@"\n'),
        _example('exec roslaunch my_robot n_talker.launch \\\n  «wrod»:=hi "$@"\n'),
    ),
    good=(_example('exec roslaunch my_robot n_talker.launch word:=hi "$@"\n'),),
    program=_find_wrong_launches,
)
