"""Help of every verb and of every program."""

import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from ur.cli.launch.command import list_groups
from ur.cli.main import main
from ur.cli.verbs import OLD_SPELLINGS, VERBS, list_pages, load_verb
from ur.cli.verbs.verb import PLUMBING
from ur.request.programs import PACKAGE, list_programs


def walk_verbs() -> Iterator[tuple[str, click.Command]]:
    for name in VERBS:
        verb = load_verb(name)
        yield name, verb
        if isinstance(verb, click.Group):
            yield from ((f"{name} {each}", command) for each, command in verb.commands.items())


COMMANDS = dict(walk_verbs())
PAGES = dict(list_pages())


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("COLUMNS", "80")
    return tmp_path


def test_every_verb_has_a_page_and_no_page_is_left_over() -> None:
    assert set(PAGES) == set(COMMANDS)


def test_no_help_needs_numpy_which_a_wheel_lacks_before_its_first_use() -> None:
    load = f"from ur.cli.verbs import load_verb\n[load_verb(name) for name in {[*VERBS]}]"
    verbs = f"import sys; sys.modules['numpy'] = None\n{load}"
    done = subprocess.run([sys.executable, "-I", "-c", verbs], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_positional_argument_is_described_and_two_examples_are_given(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    positional = [each for each in COMMANDS[name].params if isinstance(each, click.Argument)]
    assert len(PAGES[name].descriptions) == len(positional)
    assert main(["help", *name.split()]) == 0
    page = capsys.readouterr().out
    flat = re.sub(r"[\s│]+", "", page)
    for text in PAGES[name].descriptions:
        assert re.sub(r"\s+", "", text) in flat
    assert len(PAGES[name].examples) >= 2
    for example, _ in PAGES[name].examples:
        assert f"   {example}\n" in page


@pytest.mark.parametrize("name", COMMANDS)
def test_examples_use_options_and_arguments_that_the_verb_has(name: str) -> None:
    for example, _ in PAGES[name].examples:
        if "$(" in example:
            example = example.partition("$(")[2].rstrip('")')
        program, verb, *words = shlex.split(example)
        assert program == "ur"
        if verb == "help":
            continue
        command = load_verb(verb)
        path = verb
        while isinstance(command, click.Group) and words and not words[0].startswith("-"):
            path, command = f"{path} {words[0]}", command.commands[words.pop(0)]
        assert path.startswith(name) or name.startswith(path), f"{example} is about another verb than {name}"
        if "--help" in words and verb == "run":
            continue
        command.make_context(path, words)  # raises for an option or an argument that is not there


def test_help_of_ur_fits_a_terminal_of_50_lines_and_names_no_plumbing_and_no_old_spelling(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["--help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 50
    assert all(len(line) <= 80 for line in lines)
    listed = {line.split()[0] for line in lines if line.startswith("  ")}
    assert listed == {verb.name for verb in VERBS.values() if verb.section != PLUMBING}
    assert len(listed) == 36
    assert not listed & {*OLD_SPELLINGS, "env", "completion"}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("unmount a/b", "mount --undo a/b"),
        ("package --write nothing", "check --package --fix nothing"),
        ("debian remvoe", "setup debian remvoe"),
        ("x a/b word", "shell -X a/b word"),
        ("wifi --seconds soon", "doctor --wireless --seconds soon"),
        ("help wifi", "help doctor --wireless"),
    ],
)
def test_old_spelling_does_the_same_after_one_warning(
    old: str, new: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    code = main(new.split())
    page = capsys.readouterr()
    assert main(old.split()) == code
    told = capsys.readouterr()
    warning, _, rest = told.err.partition("\n")
    name = old.removeprefix("help ").split()[0]
    spelling = OLD_SPELLINGS[name][0]
    assert warning == f"warning: 'ur {name}' is now 'ur {spelling}'; the old spelling ends with the next release"
    assert (told.out, rest) == (page.out, page.err)


def test_old_spelling_is_in_no_help_text(capsys: pytest.CaptureFixture[str]) -> None:
    for name in COMMANDS:
        assert main(["help", *name.split()]) == 0
    pages = capsys.readouterr().out
    assert [old for old in OLD_SPELLINGS if re.search(rf"\bur {old}\b", pages)] == []


def test_every_option_of_launch_is_in_one_group() -> None:
    shown = [each.opts for each in load_verb("launch").params if isinstance(each, click.Option) and not each.hidden]
    grouped = [option for options in list_groups().values() for option in options]
    assert len(grouped) == len(set(grouped))
    for names in shown:
        assert len(set(names) & set(grouped)) == 1, names
    assert {"--help"} == set(grouped) - {name for names in shown for name in names}


def test_launch_help_has_its_groups(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["help", "launch"]) == 0
    page = capsys.readouterr().out
    for title in list_groups():
        assert f"─ {title} ─" in page


@pytest.mark.parametrize("program", [each.name for each in list_programs(PACKAGE / "bin")])
def test_every_program_describes_its_arguments_without_starting(
    program: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", program, "--help"]) == 0
    page = capsys.readouterr().out
    assert f"Usage: ur run {program} " in page
    assert "\n  robot_base:=stage\n" in page
    assert re.search(r"Values:\s+botvac,\s+create2,\s+loki,\s+magni,\s+stage\.", page)
    assert re.search(r"\n  world:=(maze|office)\n", page)
    assert f"Examples:\n  ur run {program}\n  ur run {program} " in page
    assert all(len(line) <= 80 for line in page.splitlines() if ":=" not in line)
    for words in (["help", program], ["help", "run", program], ["run", program, "world:=maze", "-h"]):
        assert main(words) == 0
        assert capsys.readouterr().out == page


def test_default_of_the_base_is_the_selected_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["use", "sim:magni:lidar"]) == 0
    assert main(["help", "robot_base"]) == 0
    page = capsys.readouterr().out
    assert "\n  robot_base:=magni\n" in page
    assert "\n  robot_variant:=lidar\n" in page


def test_program_without_a_launch_file_answers_help_itself(
    home: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (home / "my_robot" / "bin").mkdir(parents=True)
    (home / "my_robot" / "package.xml").write_text("<package><name>my_robot</name></package>")
    path = home / "my_robot" / "bin" / "ur_greet"
    path.write_text("#!/bin/sh\n##Summary: Greet.\n##Overview: Says hello.\n")
    path.chmod(0o755)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(home))
    assert main(["help", "greet"]) == 0
    assert "its arguments are its own" in capsys.readouterr().out
    started: list[list[str]] = []
    monkeypatch.setattr("os.execv", lambda _path, words: started.append(words))
    main(["run", "greet", "--help"])
    assert started == [[str(path), "--help"]]


def test_help_for_what_is_neither_verb_nor_program_names_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    for word, near in (("lst", "list"), ("keyboard_navigat", "keyboard_navigate")):
        assert main(["help", word]) == 2
        err = capsys.readouterr().err
        assert f"unknown command '{word}'" in err
        assert f"did you mean 'ur help {near}'?" in err
