"""Text of files and robots cannot act on the terminal, nor look like a line of ours, nor be markup."""

import re
import subprocess
from pathlib import Path

import pytest
from tests.forking import python_of_ur

from ur.cli.changing import show_changes
from ur.cli.computer.doctor import DoctorReport, print_report
from ur.cli.main import main
from ur.cli.robot_setup.network import print_table
from ur.cli.robot_setup.robot import _print_checks
from ur.cli.robots.robots import _print
from ur.robot.discovery.listing import RobotAnswer, RobotRow
from ur.robot.doctor.findings import Finding
from ur.robot.doctor.route import RouteStep
from ur.robot.setup.change import Change
from ur.robot.setup.login import Task
from ur.robot.setup.robot_states import WantedRobot
from ur.robot.setup.verify import Check
from ur.robot.ssh.address import Address

ROOT = Path(__file__).parents[2]
CLIPBOARD = "\x1b]52;c;cm0gLXJmIH4=\x07"
MOVES = "\x1b[2J\x1b[?1000h"  # an empty screen, and reports of the mouse
FORGED = "\nerror: forged"
NASTY = f"x{CLIPBOARD}{MOVES}{FORGED}"
ACTING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e]")
NODE = "bad\u009b\u202e"  # XML 1.0 allows C1 and bidirectional marks, and no ESC

CALLS = [
    "check .",
    "check --format github .",
    "check --format json .",
    "find *",
    "format --check .",
    "format --diff .",
    "docs . --output -",
    "docs . --check",
    "graph FILE",
    "graph FILE --format svg",
    "explain FILE a",
    "launch --nodes FILE",
    "launch --files FILE",
    "launch --args /NODE FILE",
    "launch --ros-args FILE",
    "launch FILE no_such:=1",
    "launch FILE.missing",
    "package .",
    "package NASTY",
    "stop NASTY",
    "use NASTY",
    "NASTY",
    "setup NASTY",
    "env NASTY",
    "check --NASTY",
    "find --NASTY",
    "debian NASTY",
    "list --format=NASTY",
]


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "nasty"
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>nasty</name></package>")
    file = folder / "launch" / f"{NASTY}.launch"
    file.write_text(
        f'<launch>\n  <!--Summary: s{NODE}-->\n <arg name="a" default="{NODE}"/>\n'
        f'  <node pkg="nasty" type="t{NODE}" name="{NODE}"/> <node/>{CLIPBOARD}\n</launch>\n'
    )
    (folder / "launch" / f"good{NASTY}.launch").write_text(
        f'<launch>\n  <!--Summary: s{NODE}-->\n <arg name="a" default="{NODE}"/>\n'
        f'<node pkg="nasty" type="t{NODE}" name="{NODE}"/>\n</launch>\n'
    )
    return folder


@pytest.mark.parametrize("call", CALLS)
def test_names_in_files_do_not_act(package: Path, call: str) -> None:
    names = {"FILE": f"launch/good{NASTY}.launch", "NASTY": NASTY}
    words = [
        re.sub("FILE|NASTY", lambda found: names[found.group()], word).replace("NODE", NODE) for word in call.split()
    ]
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(package), "LC_ALL": "C.UTF-8", "ROS_PACKAGE_PATH": ""}
    done = python_of_ur().run("ur", *words, folder=package, environment=environment)
    for text in (done.stdout.decode("utf-8", "surrogateescape"), done.stderr.decode("utf-8", "surrogateescape")):
        assert not ACTING.search(text), ascii(text)
        assert "error: forged" not in [line[:13] for line in text.splitlines()]
        assert "Traceback" not in text
        assert "internal error" not in text
    for path in package.glob("*.md"):
        assert not ACTING.search(path.read_text()), path


def test_documents_hold_no_lines_of_others(package: Path) -> None:
    done = subprocess.run(
        [ROOT / "ur", "docs", "."], cwd=package, env={"PATH": "/usr/bin:/bin"}, capture_output=True, check=True
    )
    text = (package / "launches.md").read_text()
    assert done.returncode == 0
    assert "forged" in text
    assert not ACTING.search(text)
    assert not re.search("^error: forged", text, re.M)


def test_answers_of_a_robot_are_text(capsys: pytest.CaptureFixture[str]) -> None:
    markup = "[/etc/hostname] [red]x[/red] [bold"
    task = Task(Address("ros", "bob.local"), WantedRobot(NASTY, "magni"))
    _print_checks(task, [Check(markup, NASTY, True, markup), Check(NASTY, "here", False, NASTY)])
    row = RobotRow(
        NASTY, NASTY, markup, NASTY, NASTY, RobotAnswer(services=((NASTY, "failed"),)), problem=NASTY, help=NASTY
    )
    _print([row])
    print_report(
        DoctorReport(
            {"local": NASTY, "remote": NASTY}, [Finding("rule", NASTY, help=NASTY)], [RouteStep(NASTY, False, NASTY)]
        )
    )
    print_table(("a", "b"), [(markup, NASTY)])
    show_changes([Change(NASTY, f"+ {CLIPBOARD}", ())])
    text = capsys.readouterr().out
    assert "[red]x[/red]" in "".join(text.split())
    assert not ACTING.search(text), ascii(text)
    assert "error: forged" not in [line.strip()[:13] for line in text.splitlines()]


def test_environment_arrives_as_it_is(
    capfdbinary: pytest.CaptureFixture[bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/caf\udce9/\x1b")
    assert main(["env"]) == 0
    assert b"/caf\xe9/\x1b" in capfdbinary.readouterr().out
