import subprocess
import sys
from pathlib import Path

import pytest

from ur.cli.launch.options import read_launch
from ur.cli.main import main
from ur.request.launch_request import LaunchOptions
from ur.source.arguments import split_argv

SOURCE = str(Path(__file__).parents[3] / "src")


@pytest.mark.parametrize(
    ("line", "argv", "chosen"),
    [
        ("p a.launch x:=1", "p a.launch x:=1", {}),
        ("--nodes a.launch", "a.launch", {"queries": (("nodes", None),)}),
        ("--args /n a.launch x:=-1", "a.launch x:=-1", {"queries": (("args", "/n"),)}),
        ("a.launch --args=/n --files", "a.launch", {"queries": (("files", None), ("args", "/n"))}),
        ("--node -", "-", {"queries": (("nodes", None),)}),
        ("-vp 12000 a.launch -w3", "a.launch", {"verbose": True, "port": 12000, "numworkers": 3}),
        ("--only a a.launch --only=b --no-ui", "a.launch", {"only": ("a", "b"), "plain": True}),
        ("--timeout 2.5 a.launch -- --screen", "a.launch --screen", {"timeout": 2.5}),
        ("--core --no-summary --except /a", "", {"core": True, "except_": ("/a",)}),
    ],
)
def test_options_are_read_wherever_they_stand(line: str, argv: str, chosen: dict[str, object]) -> None:
    assert read_launch(line.split()) == (split_argv(argv.split()), LaunchOptions(**chosen))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--screen=yes a.launch", "ur launch: option '--screen' takes no value"),
        ("a.launch --port", "ur launch: option '--port' requires a value"),
        ("--port 1x a.launch", "ur launch: invalid value '1x' for --port, expected a whole number from 1 to 65535"),
        ("--dump yaml a.launch", "ur launch: invalid value 'yaml' for --dump, expected json"),
        ("--respawn-limit -1 a.launch", "ur launch: invalid value '-1' for --respawn-limit, expected a whole number"),
        ("-vx a.launch", "ur launch: unknown option '-x'"),
        ("--s a.launch", "ur launch: unknown option '--s'"),
        ("--screen", "ur launch: missing argument '[PACKAGE] FILE [ARG:=VALUE]...'"),
    ],
)
def test_mistakes_in_options_are_explained(line: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", *line.split()]) == 2
    assert capsys.readouterr().err.startswith(f"error: {message}")


def _run(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(folder), "PYTHONPATH": SOURCE}
    command = [sys.executable, "-X", "importtime", "-m", "ur", *words]
    return subprocess.run(command, capture_output=True, text=True, env=environment, timeout=60, check=False)


def test_plain_question_is_answered_without_click(tmp_path: Path) -> None:
    (tmp_path / "a.launch").write_text('<launch><node pkg="p" type="t" name="n"/></launch>')
    done = _run(["launch", "--nodes", str(tmp_path / "a.launch")], tmp_path)
    assert (done.returncode, done.stdout) == (0, "/n\n")
    for heavy in ("click", "yaml", "ur.run", "ur.launchfile.dump", "ur.launchfile.plan.values.expression"):
        assert f" {heavy}\n" not in done.stderr


def test_what_is_wrong_is_said_once_and_as_ever(tmp_path: Path) -> None:
    (tmp_path / "a.launch").write_text('<launch><node pkg="p" type="t" name="$(arg no)"/></launch>')
    refused = _run(["launch", "--nodes", str(tmp_path / "a.launch")], tmp_path)
    assert refused.returncode == 1
    assert refused.stderr.count("argument 'no' is not declared") == 1
    missing = _run(["launch", "--nodes", str(tmp_path / "b.launch")], tmp_path)
    assert missing.returncode == 1  # as roslaunch
    assert missing.stderr.count("expected a launch file") == 1


def test_plain_launch_needs_no_click_and_says_what_is_wrong(tmp_path: Path) -> None:
    (tmp_path / "bad.launch").write_text("<launch><node/></launch>")
    done = _run(["launch", str(tmp_path / "bad.launch")], tmp_path)
    assert done.returncode == 1
    assert "bad.launch:1:9: error: " in done.stderr
    assert not [line for line in done.stderr.splitlines() if line.startswith("import time:") and "click" in line]
