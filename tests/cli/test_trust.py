"""The table of what commands trust: it has every verb, and those that start and send nothing do neither."""

import ast
import re
import runpy
import subprocess
import sys
from pathlib import Path

import click
import pytest

from ur.cli.verbs import VERBS, list_trust, load_verb
from ur.cli.verbs.verb import NOTHING

TRUST = dict(list_trust())
ROOT = Path(__file__).parents[2]
# Python tells its audit hooks of every program that it starts and every address that it looks up or connects to.
WATCHED = """
import sys
from ur.cli.main import main
ACTS = ("subprocess.", "os.exec", "os.posix_spawn", "os.system", "socket.connect", "socket.send", "socket.getaddr")
def note(event, details):
    if event.startswith(ACTS):
        print("ACTED", event, details, file=sys.stderr)
sys.addaudithook(note)
sys.exit(main(sys.argv[1:]))
"""
CALLS = {
    "logs": "logs nothing",
    "check": "check .",
    "format": "format --check .",
    "convert": "convert a.launch",
    "find": "find a",
    "docs": "docs . --output -",
    "explain": "explain a.launch a",
    "maps": "maps",
    "completion": "completion bash",
    "env": "env",
    "image": "image prepare image.img --dry-run",
    "graph": "graph a.launch",
}


def test_every_verb_says_what_it_trusts() -> None:
    assert {name.split()[0] for name in TRUST} == set(VERBS)
    for name in TRUST:
        verb, *below = name.split()
        command = load_verb(verb)
        assert not below or (isinstance(command, click.Group) and below[0] in command.commands), name


def test_table_of_the_page_is_that_of_the_declarations() -> None:
    tool = runpy.run_path(str(ROOT / "tools" / "make_trust_table.py"))
    page = tool["PAGE"].read_text(encoding="utf-8")
    assert page == tool["put_table"](page), "run tools/make_trust_table.py"
    assert all(re.search(rf"^\| (`ur .*)?`ur {name}`", page, re.MULTILINE) for name in TRUST)


def test_git_is_started_by_these_modules_only() -> None:
    """In a folder of others it gets none of its settings, or runs in `/`; `git config` runs nothing."""
    starting = set()
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            values = node.elts if isinstance(node, ast.List) else []
            if any(isinstance(each, ast.Constant) and each.value == "git" for each in values):
                starting.add(path.relative_to(ROOT / "src").as_posix())
    assert starting == {
        "ur/cli/files/new_things.py",  # git config user.name
        "ur/source/project.py",  # in this project's folder
    }


def test_every_command_that_starts_and_sends_nothing_is_watched() -> None:
    quiet = {name for name, trust in TRUST.items() if (trust.starts, trust.sends) == (NOTHING, NOTHING)}
    assert quiet <= set(CALLS)


@pytest.mark.parametrize("call", CALLS.values())
def test_command_that_starts_and_sends_nothing_does_neither(call: str, tmp_path: Path) -> None:
    hostile = '<launch>\n  <arg name="a" default="1"/>\n  <param name="p" command="touch ran $(arg a)"/>\n</launch>\n'
    (tmp_path / "a.launch").write_text(hostile)
    (tmp_path / "image.img").write_text("no image")
    (tmp_path / "package.xml").write_text("<package><name>mine</name></package>")
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path / "home"), "ROS_PACKAGE_PATH": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-I", "-c", WATCHED, *call.split()],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode in (0, 1, 2)
    assert [line for line in done.stderr.splitlines() if line.startswith("ACTED")] == []
    assert not (tmp_path / "ran").exists()
