import os
import subprocess
import sys
from pathlib import Path

import click
import pytest
from tests.forking import run_ur

from ur.cli.main import main
from ur.cli.verbs import VERBS, load_verb
from ur.cli.verbs.verb import PLUMBING


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path


@pytest.mark.parametrize(
    ("words", "error", "help_"),
    [
        (["lanch"], "unknown command 'lanch'", "did you mean 'ur launch'?"),
        (["xyzzy"], "unknown command 'xyzzy'", "'ur --help' lists the commands"),
        (["keyboard_driv"], "unknown command 'keyboard_driv'", "did you mean 'ur run keyboard_drive'?"),
        (["my.launch"], "unknown command 'my.launch'", "start a launch file: ur launch my.launch"),
        (["run"], "ur run: missing argument 'PROGRAM'", "'ur list' lists the programs"),
        (
            ["run", "a/b.launch"],
            "'a/b.launch' is the name of a launch file",
            "start a launch file: ur launch",
        ),
        (["--versoin"], "ur: unknown option '--versoin'", "did you mean '--version'?"),
        (["launch", "--scren", "f"], "ur launch: unknown option '--scren'", "did you mean '--screen'?"),
        (["launch"], "ur launch: missing argument", "'ur launch --help' lists the options"),
        (
            ["launch", "--port", "abc", "f"],
            "ur launch: invalid value 'abc' for --port, expected a whole number from 1 to 65535\n",
            "'ur launch --help'",
        ),
        (
            ["launch", "-p", "65536", "f"],
            "ur launch: invalid value '65536' for --port, expected a whole number from 1 to 65535\n",
            "'ur launch --help'",
        ),
        (
            ["launch", "--timeout", "0", "f"],
            "ur launch: invalid value '0' for --timeout, expected a number above 0, up to 1000000\n",
            "'ur launch --help'",
        ),
        (
            ["logs", "-n", "-1"],
            "ur logs: invalid value '-1' for --lines, expected a whole number from 0 up\n",
            "'ur logs --help'",
        ),
        (
            ["new", "node", "x", "--seconds", "soon"],
            "ur new node: invalid value 'soon' for --seconds, expected a number\n",
            "'ur new node --help'",
        ),
        (["use", "a", "b"], "ur use: got unexpected extra argument (b)", "'ur use --help'"),
        (
            ["run", "keyboard_navigat"],
            "unknown program 'keyboard_navigat'",
            "did you mean 'ur run keyboard_navigate'?",
        ),
        (["run", "../ur"], "unknown program '../ur'", ""),
        (["boot", "stat"], "unknown command 'ur boot stat'", "did you mean 'ur boot status'?"),
        (["robot", "xyz"], "unknown command 'ur robot xyz'", "'ur robot --help' lists the commands"),
        (["check", "--explain", "nix"], "--explain nix: no such rule, expected an id", "'ur check --explain' lists"),
        (["graph", ""], "no file '', expected a launch file", "give a path, or a package and a file name"),
        (["topic", "list"], "unknown command 'topic'", "use the tool of ROS: rostopic list"),
        (["maps", "join", "a", "b"], "unknown command 'ur maps join'", "did you mean 'ur maps merge'?"),
        (
            ["world:=office"],
            "unknown command 'world:=office'",
            "arguments follow a program: ur run PROGRAM world:=office",
        ),
        (["help", "lst"], "unknown command 'lst'", "did you mean 'ur help list'?"),
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


@pytest.mark.parametrize(
    ("words", "error", "help_"),
    [
        (["graph", "files"], "files is a folder, expected one of files/a.launch, files/b.launch", "give a file: files"),
        (["explain", "other", "x"], "other is a folder, expected a launch file", "give a path, or a package and"),
        (
            ["launch", "files/a.launch", "x"],
            "'x' is not an argument: the launch file declares no arguments",
            "leave x out",
        ),
        (["robot_base", "x:=y"], "unknown command 'robot_base'", "did you mean 'ur run robot_base'?"),
        (["graph", "files/none/c.launch"], "no file 'files/none/c.launch'", "give a path"),
    ],
)
def test_folders_and_files_in_the_wrong_place_are_explained(
    words: list[str],
    error: str,
    help_: str,
    home: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(home)
    for folder in ("files", "other"):
        Path(folder).mkdir()
    for file in ("files/a.launch", "files/b.launch", "other/notes"):
        Path(file).write_text("<launch/>")
    test_wrong_command_line_gets_one_line_and_exit_2(words, error, help_, capsys)


def test_help_names_every_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    page = capsys.readouterr().out
    for verb in VERBS.values():
        if verb.section == PLUMBING:
            continue
        assert verb.name in page
        assert verb.summary.replace("`", "") in page.replace("`", "")
    assert main(["--help"]) == 0
    assert capsys.readouterr().out == page


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_a_page_that_begins_with_its_summary(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert (load_verb(verb).help or "").split("\n")[0] == VERBS[verb].summary
    assert main([verb, "--help"]) == 0
    page = capsys.readouterr().out
    assert f"Usage: ur {verb}" in page
    assert main(["help", verb]) == 0
    assert capsys.readouterr().out == page


def test_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("ur 0.")


def test_defect_becomes_one_line_and_a_file(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    @click.command("use")
    def broken() -> None:
        raise RuntimeError("oops")

    assert main(["use"], lambda _: broken) == 2
    told = capsys.readouterr().err
    assert "error: internal error in 'ur use': RuntimeError: oops" in told
    assert "Traceback" not in told
    [log] = (home / "state/ubiquity_launches").iterdir()
    assert str(log) in told
    assert "Traceback" in log.read_text()


@pytest.mark.parametrize(
    "words",
    [
        ["check", "--package", "{long}"],
        ["run", "robot_base", "world:={long}"],
        ["run", "robot_base", "world:=./{long}.yaml"],
        ["run", "robot_base", "robot_base:={long}"],
        ["run", "keyboard_navigate", "map_file:=./{long}.yaml"],
        ["image", "prepare", "{long}", "--name", "bob"],
    ],
)
def test_name_that_the_file_system_refuses_is_no_internal_error(words: list[str], home: Path) -> None:
    long = (word.format(long="x" * 300) for word in words)
    done = run_ur(*long, folder=home, environment={**os.environ, "HOME": str(home)})
    assert done.returncode in (1, 2)
    assert done.stderr.startswith("error: ")
    assert "file name too long" in done.stderr or "is not known" in done.stderr
    assert "  help: " in done.stderr
    assert "internal error" not in done.stderr


def test_missing_permission_is_no_internal_error(capsys: pytest.CaptureFixture[str]) -> None:
    @click.command("use")
    def refused() -> None:
        raise PermissionError(13, "Permission denied", "/a folder/x\x1b")

    assert main(["use"], lambda _: refused) == 2
    assert capsys.readouterr().err == (
        "error: '/a folder/x\\x1b' cannot be used: permission denied\n"
        "  help: list the permissions of all folders above it: namei -l '/a folder/x\\x1b'\n"
    )


def test_interrupt_is_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    @click.command("use")
    def interrupted() -> None:
        raise KeyboardInterrupt

    assert main(["use"], lambda _: interrupted) == 130
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
            {"rich", "rich_click", "textual", "asyncio", "http.client", "xmlrpc.client", "rospkg"}
            | {"dataclasses", "inspect", "msgspec"},  # these take as long as everything else
        ),
    ],
)
def test_verbs_import_only_what_they_need(words: list[str], unwanted: set[str]) -> None:
    code = f"import sys; from ur.cli.main import main; main({words!r}); print('\\n' + ' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not unwanted & set(done.stdout.splitlines()[-1].split())


def test_modules_of_a_launch_need_nothing_that_takes_long_to_import() -> None:
    names = ("request.launch", "request.joining.running", "request.requirements.preparation", "run.launch")
    code = "; ".join(
        f"import ur.{name}" for name in (*names, "run.middleware.ros1", "cli.launch.launch", "complete.completions")
    )
    code += "; import sys; sys.exit(' '.join({'dataclasses', 'inspect', 'msgspec'} & {*sys.modules}) or 0)"
    done = subprocess.run([sys.executable, "-I", "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_python_of_a_clone_starts_without_a_finder() -> None:
    code = "import sys; print(' '.join(sys.modules), '\\n', *sys.path, sep='\\n')"
    done = subprocess.run([sys.executable, "-I", "-c", code], capture_output=True, text=True, check=True)
    modules, _, *paths = done.stdout.splitlines()
    assert str(Path(__file__).parents[2] / "src") in paths
    assert "__editable__" not in modules
