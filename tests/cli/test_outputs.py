"""An output that the user names is never a file that the command reads, and never replaces a file of another kind."""

import os
import socket
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import numpy as np
import pytest

from ur.cli.launch.launch import _pid_file
from ur.cli.main import main
from ur.cli.robot_setup.image import _opened
from ur.cli.runs.logs import find_ended_run
from ur.cli.verbs import VERBS, load_verb
from ur.maps.picture_file import write_picture
from ur.run.record.registry import EndedRun, RunEntry, write_ended
from ur.source.diagnostic import UserError
from ur.source.replace import check_output, output_file

Case = tuple[Path, Callable[[], None]]  # a file that a command reads, and the command with it as the output
LAUNCH = "<launch><node name='n' pkg='p' type='t'/></launch>\n"
INPUTS = {
    ("launch", "--report"),  # of `ur` on the robot, which names a file of its own
    ("get", "--index"),
    ("explain", "argv"),
    ("graph", "argv"),
    ("image prepare", "--from"),
    ("image prepare", "image"),
    ("launch", "argv"),
    ("maps import", "file"),
    ("new base", "--from"),
    ("new world", "--picture"),
    ("replay", "recording"),
    ("robot setup", "--from"),
    ("sync", "paths"),
}
FOLDERS = {  # of files with new names
    ("convert", "--prefix"),
    ("mount", "--at"),
    ("new base", "--workspace"),
    ("record", "--to"),
}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "HOME"):
        monkeypatch.setenv(name, str(tmp_path / name.lower()))
    (tmp_path / "a.launch").write_text(LAUNCH)
    return tmp_path


def _call(*words: str) -> Callable[[], None]:
    def run() -> None:
        assert main(list(words)) == 2

    return run


def _export(_: pytest.MonkeyPatch) -> Case:
    plan = write_picture(Path("plan"), np.zeros((2, 2), np.int8), 0.1, (0.0, 0.0, 0.0))
    assert main(["maps", "import", str(plan), "flat"]) == 0
    (stored,) = Path("xdg_data_home").rglob("map.yaml")
    return stored, _call("maps", "export", "flat", str(stored))


def _pid(_: pytest.MonkeyPatch) -> Case:
    def run() -> None:
        with pytest.raises(UserError), _pid_file("a.launch", ["a.launch"]):
            pass

    return Path("a.launch"), run


def _image(_: pytest.MonkeyPatch) -> Case:
    image = Path("robot.img")
    image.write_bytes(bytes(2048))

    def run() -> None:
        with pytest.raises(UserError), _opened(image, image):
            pass

    return image, run


def _log(monkeypatch: pytest.MonkeyPatch) -> Case:
    program = Path("ping")
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(Path.cwd()))
    return Path("a.launch"), _call("doctor", "--wireless", "nobody@localhost", "--log", "a.launch")


def _report(_: pytest.MonkeyPatch) -> Case:
    logs = Path("logs").absolute()
    logs.mkdir()
    (logs / "n.log").write_text("a line\n")
    entry = RunEntry("run", 1, 1, "a.launch", "", str(logs), 1.0, False, socket.gethostname())
    write_ended(EndedRun(entry, 2.0, 0), os.environ, os.getuid())
    assert find_ended_run(None) is not None
    return logs / "n.log", _call("report", "--output", "logs/n.log")


OUTPUTS: dict[tuple[str, str], Callable[[pytest.MonkeyPatch], Case]] = {
    ("convert", "--output"): lambda _: (Path("a.launch"), _call("convert", "a.launch", "--output", "a.launch")),
    ("docs", "--output"): lambda _: (Path("a.launch"), _call("docs", ".", "--output", "a.launch")),
    ("graph", "--output"): lambda _: (Path("a.launch"), _call("graph", "a.launch", "-o", "a.launch")),
    ("image prepare", "--output"): _image,
    ("launch", "--pid"): _pid,
    ("maps export", "file"): _export,
    ("report", "--output"): _report,
    ("doctor", "--log"): _log,
}


def _walk(name: str, verb: click.Command) -> Iterator[tuple[str, click.Parameter]]:
    for each in verb.params:
        yield name, each
    for below, command in getattr(verb, "commands", {}).items():
        yield from _walk(f"{name} {below}", command)


def test_every_option_that_names_a_file_is_known_as_an_input_or_an_output() -> None:
    found = set()
    for verb in VERBS:
        for name, each in _walk(verb, load_verb(verb)):
            words = set((each.metavar or "").strip("[].").replace("|", " ").split())
            option = max(each.opts, key=len)
            if isinstance(each.type, click.Path) or words & {"FILE", "FOLDER", "DIR"} or "output" in option:
                found.add((name, option))
    found -= {("get", "words"), ("stop", "--output")}
    missing = {each for each in found if each not in {*INPUTS, *FOLDERS, *OUTPUTS}}
    assert not missing
    assert set(OUTPUTS) <= found


@pytest.mark.parametrize("option", OUTPUTS, ids=" ".join)
def test_output_that_names_an_input_changes_nothing(option: tuple[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    path, run = OUTPUTS[option](monkeypatch)
    before = path.read_bytes()
    run()
    assert path.read_bytes() == before


@pytest.mark.parametrize("content", [b"", b"PK old"])
def test_output_replaces_an_empty_file_and_one_of_its_kind(folder: Path, content: bytes) -> None:
    path = folder / "out.zip"
    path.write_bytes(content)
    with output_file(path, begin=b"PK") as file:
        file.write(b"PK new")
    assert path.read_bytes() == b"PK new"


def test_output_is_not_changed_when_it_cannot_be_completed(folder: Path) -> None:
    path = folder / "out.zip"
    path.write_bytes(b"PK old")
    with pytest.raises(TypeError), output_file(path, begin=b"PK") as file:
        file.writelines([b"PK new", None])  # type: ignore[list-item]
    assert path.read_bytes() == b"PK old"
    assert {each.name for each in folder.iterdir()} == {"out.zip", "a.launch"}


@pytest.mark.parametrize("make", [Path.mkdir, lambda path: path.write_text("precious")])
def test_output_that_is_of_another_kind_is_refused(folder: Path, make: Callable[[Path], object]) -> None:
    path = folder / "other"
    make(path)
    with pytest.raises(UserError, match=r"expected"):
        check_output(path, begin=b"PK")


def test_stream_is_written_to_as_it_is_and_one_without_a_reader_is_refused(folder: Path) -> None:
    with output_file("/dev/null", begin=b"PK") as file:
        file.write(b"PK")
    os.mkfifo(folder / "pipe")
    with pytest.raises(UserError, match="expected a file that can be written"), output_file(folder / "pipe"):
        pass
    reader = os.open(folder / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    with output_file(folder / "pipe", begin=b"PK") as file:
        file.write(b"PK new")
    assert os.read(reader, 64) == b"PK new"
    os.close(reader)


def test_input_is_found_under_another_name(folder: Path) -> None:
    os.link(folder / "a.launch", folder / "hard")
    (folder / "soft").symlink_to("a.launch")
    for name in ("hard", "soft", "./a.launch"):
        with pytest.raises(UserError, match="is read for this output"):
            check_output(folder / name, [folder / "a.launch"], LAUNCH[:4].encode())
