from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import click
import pytest

from ur.cli import main as cli
from ur.cli.help import SECTIONS
from ur.cli.main import VERBS, load_verb, main


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path


@pytest.mark.parametrize(
    ("words", "error", "help_"),
    [
        (["lanch"], "'lanch' is not a verb of ur, expected one of run, ", "did you mean 'ur launch'?"),
        (["xyzzy"], "'xyzzy' is not a verb of ur", "'ur --help' shows what there is"),
        (["--versoin"], "--versoin is not an option of 'ur'", "did you mean '--version'?"),
        (["launch", "--scren", "f"], "--scren is not an option of 'ur launch'", "did you mean '--screen'?"),
        (["launch"], "ur launch: missing argument", "'ur launch --help' shows what there is"),
        (["launch", "-p", "zero", "f"], "ur launch: invalid value for '-p'", "'ur launch --help'"),
        (["use", "a", "b"], "ur use: got unexpected extra argument (b)", "'ur use --help'"),
        (
            ["run", "keyboard_navigat"],
            "program 'keyboard_navigat' is not known",
            "did you mean 'ur run keyboard_navigate'?",
        ),
        (["run", "../ur"], "program '../ur' is not known", ""),
        (["help", "lst"], "'lst' is not a verb of ur", "did you mean 'ur list'?"),
    ],
)
def test_wrong_command_line_gets_one_line_and_exit_2(
    words: list[str], error: str, help_: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"error: {error}")
    assert f"  help: {help_}" in told
    assert len(told.splitlines()) == 2


def test_help_names_every_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    page = capsys.readouterr().out
    for verb, (_, summary) in VERBS.items():
        assert verb in page
        assert summary.replace("`", "") in page.replace("`", "")
    assert main(["--help"]) == 0
    assert capsys.readouterr().out == page


def test_every_verb_stands_in_one_section_of_the_help() -> None:
    assert sorted(verb for verbs in SECTIONS.values() for verb in verbs) == sorted(VERBS)


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_a_page_that_begins_with_its_summary(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert (load_verb(verb).help or "").split("\n")[0] == VERBS[verb][1]
    assert main([verb, "--help"]) == 0
    page = capsys.readouterr().out
    assert f"Usage: ur {verb}" in page
    assert main(["help", verb]) == 0
    assert capsys.readouterr().out == page


def test_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("ur 0.")


def test_defect_becomes_one_line_and_a_file(
    monkeypatch: pytest.MonkeyPatch, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    @click.command("use")
    def broken() -> None:
        raise RuntimeError("oops")

    monkeypatch.setattr(cli, "load_verb", lambda _: broken)
    assert main(["use"]) == 2
    told = capsys.readouterr().err
    assert "error: 'ur use' failed for a reason that is a defect of ur: RuntimeError: oops" in told
    assert "Traceback" not in told
    [log] = (home / "state/ubiquity_launches").iterdir()
    assert str(log) in told
    assert "Traceback" in log.read_text()


def test_interrupt_is_quiet(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    @click.command("use")
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "load_verb", lambda _: interrupted)
    assert main(["use"]) == 130
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", "")


def test_closed_pipe_is_quiet() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run([sys.executable, "-m", "ur", "list"], stdout=writer, stderr=subprocess.PIPE, check=False)
    os.close(writer)
    assert done.stderr == b""


@pytest.mark.parametrize(
    ("words", "unwanted"),
    [
        (["use"], {"rich", "rich_click", "yaml", "textual", "asyncio", "http.client", "ur.run", "ur.launchfile"}),
        (["list"], {"rich", "rich_click", "textual", "asyncio", "http.client", "xmlrpc.client", "rospkg"}),
        (
            ["launch", "no_such_file"],
            {"rich", "rich_click", "textual", "asyncio", "http.client", "xmlrpc.client", "rospkg"},
        ),
    ],
)
def test_verbs_import_only_what_they_need(words: list[str], unwanted: set[str]) -> None:
    code = f"import sys; from ur.cli.main import main; main({words!r}); print('\\n' + ' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not unwanted & set(done.stdout.splitlines()[-1].split())
