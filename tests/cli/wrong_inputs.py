"""Wrong inputs of every verb, and what `ur` prints for them: the golden file messages.txt is made from this."""

import io
import os
import re
import shlex
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

import click
from tests.cli.wrong_lines import LINES

from ur.cli.main import main
from ur.cli.verbs import VERBS, load_verb

GOLDEN = Path(__file__).with_name("messages.txt")
LIBRARY = Path(__file__).parents[2] / "ubiquity_launches"
TALKER = '<launch>\n  <node name="talker" pkg="demo" type="talker"/>\n</launch>\n'
SPEED = '<launch>\n  <arg name="speed"/>\n  <param name="v" value="$(arg speed)"/>\n</launch>\n'
FILES: Mapping[str, str] = {
    "src/demo/package.xml": "<package>\n  <name>demo</name>\n</package>\n",
    "src/demo/launch/talker.launch": TALKER,
    "src/demo/launch/twice.launch": TALKER,
    "src/demo/other/twice.launch": TALKER,
    "src/demo/launch/speed.launch": SPEED,
    "src/demo/bin/talker": "#!/bin/sh\nexit 0\n",
    "empty.launch": "",
    "text.launch": "this is no XML\n",
    "ros2.launch": '<launch>\n  <let name="speed" value="1"/>\n</launch>\n',
    "ros2.launch.py": "def generate_launch_description():\n    pass\n",
    "missing.launch": '<launch>\n  <include file="$(find demo)/launch/talkr.launch"/>\n</launch>\n',
    "package.launch": '<launch>\n  <include file="$(find dmeo)/launch/talker.launch"/>\n</launch>\n',
    "node.launch": '<launch>\n  <node name="talker" pkg="demo" type="tlker"/>\n</launch>\n',
    "machine.launch": '<launch>\n  <node name="talker" pkg="demo" type="talker" machine="robto"/>\n</launch>\n',
    "notes.txt": "buy a battery\n",
    "robots.yaml": "robots: 3\n",
    "list.yaml": "- a\n- b\n",
    "picture.png": "no picture\n",
}


def list_lines() -> list[list[str]]:
    """Every command line: those that follow from the options and arguments of each command, then those of LINES."""
    derived = [line for path, command in list_commands() for line in _derive(path, command)]
    return [*derived, *map(shlex.split, LINES)]


def list_commands() -> Iterator[tuple[list[str], click.Command]]:
    """Every verb and its subcommands, with the words that call it."""
    for verb in VERBS:
        command = load_verb(verb)
        yield [verb], command
        if isinstance(command, click.Group):
            yield from (([verb, name], each) for name, each in command.commands.items())


def _derive(path: list[str], command: click.Command) -> Iterator[list[str]]:
    if isinstance(command, click.Group):
        yield [*path, "nonsense"]
        return
    if not command.context_settings.get("ignore_unknown_options"):
        yield [*path, "--nonsense"]
    arguments = [each for each in command.params if isinstance(each, click.Argument)]
    if any(each.required for each in arguments):
        yield path
    if all(each.nargs == 1 for each in arguments):
        yield [*path, *("word" for _ in arguments), "more"]
    options = [
        each for each in command.params if isinstance(each, click.Option) and not each.is_flag and not each.count
    ]
    if options:
        yield [*path, max(options[0].opts, key=len)]
    for each in options:
        option = max(each.opts, key=len)
        if isinstance(each.type, click.Choice | click.types.IntParamType | click.types.FloatParamType):
            yield [*path, option, "wrong"]
        if isinstance(each.type, click.IntRange | click.FloatRange) and each.type.min is not None:
            yield [*path, option, "-1"]


def describe_messages() -> str:
    """The golden text: each command line, its exit code and what it prints."""
    with tempfile.TemporaryDirectory() as folder, enter_folder(Path(folder)):
        return "".join(describe(words, folder) for words in list_lines())


@contextmanager
def enter_folder(folder: Path) -> Iterator[None]:
    """Make a folder with FILES the working folder and home, and know nothing else of this computer."""
    for name, text in FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    (folder / "src/demo/bin/talker").chmod(0o755)
    (folder / "empty").mkdir()
    (folder / "runtime").mkdir(mode=0o700)
    before = Path.cwd()
    variables = {
        **{name: str(folder / name.lower()) for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME")},
        "PATH": os.environ.get("PATH", ""),
        "HOME": str(folder),
        "XDG_RUNTIME_DIR": str(folder / "runtime"),
        "ROS_HOME": str(folder / "ros"),
        "ROS_PACKAGE_PATH": f"{folder / 'src'}:{LIBRARY}",
        "ROS_MASTER_URI": "http://localhost:1",
        "NO_COLOR": "1",
        "COLUMNS": "100",
        "LANG": "C.UTF-8",
    }
    with ExitStack() as replaced:
        replaced.enter_context(patch.dict(os.environ, variables, clear=True))
        for name in ("execv", "execve", "execvp", "execvpe"):
            replaced.enter_context(patch.object(os, name, _refuse_exec))
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def _refuse_exec(*words: object) -> None:
    raise AssertionError(f"this input is not wrong: another program would take the place of this process: {words}")


def describe(words: list[str], folder: str) -> str:
    """One command line, its exit code and what it prints."""
    printed = io.StringIO()
    with redirect_stdout(printed), redirect_stderr(printed), patch.object(sys, "stdin", io.StringIO()):
        code = main(words)
    text = re.sub(rf"{re.escape(tempfile.gettempdir())}/tmp\w+", "TMP", printed.getvalue().replace(folder, "~"))
    text = text.replace(str(LIBRARY.parent), "UR")
    lines = "".join(f"    {line}".rstrip() + "\n" for line in text.splitlines())
    return f"$ ur {shlex.join(words)}\n  -> {code}\n{lines}\n"
