"""Tab on names that hold characters of the shell, in real shells on a real terminal."""

import os
import shutil
import socketserver
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.forking import python_of_ur
from tests.terminal import TmuxTerminal

from ur.complete.verbs import SCRIPTS

STARTS = {
    "bash": ["bash", "--noprofile", "--norc", "-i"],
    "zsh": ["zsh", "-f", "-i"],
    "fish": ["fish", "--no-config", "-i"],
}
NAMES = [
    "y;touch ran;.launch",
    "$(touch ran)",
    "`touch ran`",
    "a'b;touch ran;'c",
    'a"b;touch ran;"c',
    "a b|touch ran&",
    "a\\",
    "~root",
    "#x",
    "=ls",
    "{a,b}*?[c]",
    "x!!y!z",
    "x:=y:z=w",
    "é 漢",
    " b'c\"d$e`f;g|h&i<j>k(l)m{n,o}p[q]r*s?t!u~v#w\\x=y:z%^@+",
]
UR = """#!/bin/bash
if [[ $1 == __complete ]]; then # in a fork of an interpreter
  exec 3<>/dev/tcp/127.0.0.1/{port} && printf '%s\\0' $# "$PWD" "$@" >&3 && exec cat <&3
fi
printf '%s\\0' "$@" >"{told}.new" && mv "{told}.new" "{told}"
"""


class Completion(socketserver.StreamRequestHandler):
    """Answers the folder and the arguments of an `ur` with what it prints."""

    def handle(self) -> None:
        count = int(self.read_word())
        folder, *words = (self.read_word() for _ in range(1 + count))
        environment = {**os.environ, "HOME": folder, "ROS_PACKAGE_PATH": folder}
        self.wfile.write(python_of_ur().run("ur", *words, folder=Path(folder), environment=environment).stdout)

    def read_word(self) -> str:
        return os.fsdecode(b"".join(iter(lambda: self.rfile.read(1), b"\0")))


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    with socketserver.TCPServer(("127.0.0.1", 0), Completion) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.05,))
        thread.start()
        yield server.server_address[1]
        server.shutdown()
        thread.join()


@pytest.fixture(params=sorted(STARTS))
def terminal(request: pytest.FixtureRequest, tmp_path: Path, port: int) -> Iterator[TmuxTerminal]:
    for program in ("tmux", request.param):
        if not shutil.which(program):
            pytest.skip(f"{program} is not installed")
    for number, name in enumerate(NAMES):
        (tmp_path / f"d{number}").mkdir()
        (tmp_path / f"d{number}" / name).touch()
    script = tmp_path / f"complete.{request.param}"
    script.write_text(SCRIPTS[request.param])
    opened = TmuxTerminal(STARTS[request.param], tmp_path)
    (tmp_path / "ur").write_text(UR.format(port=port, told=tmp_path / "told"))
    opened.type(f". ./{script.name}; echo rea''dy", "Enter")
    opened.until("ready")
    yield opened
    opened.close()


@pytest.mark.parametrize("quote", ["", "'", '"'])
def test_completed_name_arrives_as_one_word_and_runs_nothing(
    terminal: TmuxTerminal, tmp_path: Path, quote: str
) -> None:
    told = tmp_path / "told"
    for number, name in enumerate(NAMES):
        terminal.type(f"ur check {quote}d{number}/", "Tab")
        terminal.type("Enter")
        end = time.monotonic() + 30
        while not told.exists():
            assert time.monotonic() < end, f"{name!r} was not completed:\n{terminal.screen()}"
            time.sleep(0.02)
        assert told.read_text().split("\0")[:-1] == ["check", f"d{number}/{name}"], terminal.screen()
        told.unlink()
    assert not list(tmp_path.rglob("ran"))


def test_program_of_the_current_folder_is_not_started_by_tab(terminal: TmuxTerminal, tmp_path: Path) -> None:
    downloaded = tmp_path / "downloaded"
    downloaded.mkdir()
    (downloaded / "ur").write_text(f"#!/bin/sh\ntouch {tmp_path}/ran\n")
    (downloaded / "ur").chmod(0o755)
    terminal.type("cd downloaded; echo mov''ed", "Enter")
    terminal.until("moved")
    terminal.type("./ur laun", "Tab")
    terminal.until("./ur launch")
    terminal.type("C-c")
    assert not (tmp_path / "ran").exists()


def test_names_with_control_characters_are_not_offered(terminal: TmuxTerminal, tmp_path: Path) -> None:
    (tmp_path / "odd").mkdir()
    for name in ("a\nopen\tb", "a\x1b]0;t\x07", "a\tb", "after"):
        (tmp_path / "odd" / name).touch()
    terminal.type("ur check odd/", "Tab")
    terminal.until("ur check odd/after")
    terminal.type("C-c")
