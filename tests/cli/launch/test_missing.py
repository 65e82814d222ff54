"""Packages that a launch file lacks: xacro is made before anything starts, others are named with the command."""

import functools
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest

from ur.cli.launch import launch as missing
from ur.request.launch import Launch, load_with_packages
from ur.request.launch_request import LaunchOptions, StartReporter
from ur.request.plan_files import LoadedPlan
from ur.robot.selection import Selection, load_selection
from ur.source.arguments import CommandLine
from ur.source.diagnostic import UserError, error

FILE = """<launch>
  <param name="robot_description" command="$(find xacro)/xacro robot.xacro"/>
</launch>"""


@pytest.fixture
def selection(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Selection:
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME"):
        monkeypatch.setenv(name, str(tmp_path / name))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "none"))
    monkeypatch.setenv("PATH", "/usr/bin:/bin")  # the verb changes it; this brings it back afterwards
    for name in ("UR_SELECTION", "ROS_MASTER_URI", "ROS_HOSTNAME"):
        monkeypatch.setenv(name, "")
    return load_selection(tmp_path / "no-selection")


def write(tmp_path: Path, text: str) -> str:
    path = tmp_path / "a.launch"
    path.write_text(text, encoding="utf-8")
    return str(path)


def load(file: str, selection: Selection, make_xacro: Callable[[], None] = missing.make_xacro) -> LoadedPlan:
    options = LaunchOptions()
    offer = functools.partial(missing.offer, options)
    return load_with_packages(
        Launch(CommandLine((file,)), selection, options, StartReporter(), ExitStack(), make_xacro, offer)
    )


def make_in(packages: Path) -> None:
    folder = packages / "xacro"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>xacro</name></package>", encoding="utf-8")


def test_xacro_is_made_where_a_description_calls_it_and_no_error_is_shown(
    tmp_path: Path, selection: Selection, capsys: pytest.CaptureFixture[str]
) -> None:
    packages = tmp_path / "XDG_DATA_HOME/ubiquity_launches/packages"
    loaded = load(write(tmp_path, FILE), selection, lambda: make_in(packages))
    assert loaded.plan is not None
    assert loaded.plan.params[0].command.startswith(f"{packages}/xacro/xacro ")  # type: ignore[union-attr]
    assert not capsys.readouterr().err


def test_xacro_that_cannot_be_made_is_the_only_error(tmp_path: Path, selection: Selection) -> None:
    def fail() -> None:
        raise UserError(error("xacro could not be installed: no network", rule="no-package"))

    with pytest.raises(UserError, match="no network"):
        load(write(tmp_path, FILE), selection, fail)


def test_command_that_gets_other_packages_is_printed_without_a_terminal(
    tmp_path: Path, selection: Selection, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write(tmp_path, '<launch><include file="$(find rover_bringup)/all.launch"/></launch>')
    loaded = load(file, selection)
    assert loaded.plan is None
    assert "help: ur get rover_bringup prints how to get what is missing" in capsys.readouterr().err


def test_agreement_on_a_terminal_gets_the_packages_and_reads_the_file_again(
    tmp_path: Path, selection: Selection, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    def get(names: list[str]) -> int:
        folder = tmp_path / "none/rover_bringup"
        folder.mkdir(parents=True)
        (folder / "package.xml").write_text("<package><name>rover_bringup</name></package>", encoding="utf-8")
        (folder / "all.launch").write_text("<launch/>", encoding="utf-8")
        asked.extend(names)
        return 0

    monkeypatch.setattr(missing, "_can_ask", lambda _options: True)
    monkeypatch.setattr("ur.cli.files.get.get_packages", get)
    monkeypatch.setattr("click.confirm", lambda *_words, **_more: True)
    file = write(tmp_path, '<launch><include file="$(find rover_bringup)/all.launch"/></launch>')
    loaded = load(file, selection)
    assert (loaded.plan is not None, asked) == (True, ["rover_bringup"])
