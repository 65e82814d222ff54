"""Rules about the programs in a package's folder `bin`."""

import re
from collections.abc import Iterable

from ur.check.example_parts import PROGRAM_HEAD, make_talk_launch
from ur.check.rule import Example, LaunchView, ProgramView, Rule, RuleFinding, RuleGroup
from ur.source.diagnostic import Severity
from ur.source.file import Span
from ur.source.suggest import suggest

_HEADINGS = {name: re.compile(rf"^##\s*{name}:\s*\S", re.MULTILINE) for name in ("Summary", "Overview")}


def _find_undocumented(view: ProgramView) -> Iterable[RuleFinding]:
    if view.source.path.endswith("/bin/ur"):  # the command itself
        return
    missing = [name for name, pattern in _HEADINGS.items() if not pattern.search(view.source.text)]
    if missing:
        first_line = view.source.text.partition("\n")[0]
        yield RuleFinding(
            Span(view.source, 0, len(first_line)),
            f"a program without {' and '.join(missing)}, expected comments that say what it does",
            "write " + " and ".join(f"##{name}: ..." for name in missing) + " after the first line",
            subject=missing[0],
        )


_DOCUMENTED_PROGRAM = """#!/bin/bash
##Summary: Say something.
##Overview: Once per second, until
## Control-C.
exec roslaunch my_robot n_talker.launch.xml "$@"
"""


def _program_example(program: str) -> Example:
    return Example({"bin/ur_talk": program, "n_talker/launch/n_talker.launch.xml": make_talk_launch()})


_COMMAND = re.compile(r"^[^#\n]*\blaunch\b(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE)
_FILE = re.compile(r"(?<![\w.*$}])(?:[\w./-]{0,100}/)?(\w+\.launch(?:\.xml)?)(?![\w.])")
_ARGUMENT = re.compile(r"(?<![\w$])(\w+):=")


def _find_wrong_launches(view: ProgramView) -> Iterable[RuleFinding]:
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
            message = f"{view.package.name} has no launch file {file.group(1)}, expected one"
            yield RuleFinding(span, message, suggest(file.group(1), by_name) or "check the name")
        else:
            yield from _check_arguments(command, launch, view)


def _is_ours(command: str, file: re.Match[str], view: ProgramView) -> bool:
    words = command[: file.start()].split()
    return bool(words) and words[-1].strip("\"'") == view.package.name


def _check_arguments(command: re.Match[str], launch: LaunchView, view: ProgramView) -> Iterable[RuleFinding]:
    for argument in _ARGUMENT.finditer(command.group()):
        name = argument.group(1)
        if name not in launch.declared and not name.startswith("_"):
            known = ", ".join(sorted(launch.declared)) or "none"
            yield RuleFinding(
                Span(view.source, command.start() + argument.start(1), command.start() + argument.end(1)),
                f"argument '{name}' is given, but {launch.path} does not declare it",
                suggest(name, launch.declared) or f"declared: {known}",
            )


def _command_example(command: str) -> Example:
    launch = make_talk_launch('<arg name="word" default="hello"/>', "<!--word: What is said.-->", says="$(arg word)")
    return Example({"bin/ur_talk": PROGRAM_HEAD + command, "n_talker/launch/n_talker.launch": launch})


RULES = (
    Rule(
        id="program-documentation",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="A program does not say what it does.",
        explanation="""
`ur list` shows the line `##Summary:` of each program in `bin`, and `ur docs` its `##Overview:`, which goes on in the
lines with `##` that follow.
""",
        bad=(
            _program_example(
                '«#!/bin/bash»\n##Summary: Say something.\nexec roslaunch my_robot n_talker.launch.xml "$@"\n'
            ),
        ),
        good=(_program_example(_DOCUMENTED_PROGRAM),),
        program=_find_undocumented,
    ),
    Rule(
        id="program-launch-file",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="A program starts a launch file that is not there, or gives it an unknown argument.",
        explanation="""
Lines of programs in `bin` that start a launch file of their own package, with roslaunch or `ur launch`.
""",
        bad=(
            _command_example('exec roslaunch my_robot «n_talkr.launch» "$@"\n'),
            _command_example('exec roslaunch my_robot n_talker.launch \\\n  «wrod»:=hi "$@"\n'),
        ),
        good=(_command_example('exec roslaunch my_robot n_talker.launch word:=hi "$@"\n'),),
        program=_find_wrong_launches,
    ),
)
