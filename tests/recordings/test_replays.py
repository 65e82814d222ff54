"""Commands to replays."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from ur.recordings.replays import ReplayCommand, read_command, send_command, sockets_folder, write_command


@pytest.mark.parametrize("command", [ReplayCommand("pause"), ReplayCommand("jump", 12.25), ReplayCommand("speed", 0.5)])
def test_command_is_read_as_it_was_written(command: ReplayCommand) -> None:
    assert read_command(write_command(command)) == command


@pytest.mark.parametrize("data", [b"", b"jump", b"rewind 3", b"jump nan", b"jump 1 2", b"\xff\xfe", b"speed inf"])
def test_other_data_is_no_command(data: bytes) -> None:
    assert read_command(data) in (None, ReplayCommand("jump"))


def test_replay_that_was_killed_takes_nothing(tmp_path: Path) -> None:
    environment = {"XDG_STATE_HOME": str(tmp_path)}
    assert send_command(ReplayCommand("pause"), environment) == 0
    path = Path(sockets_folder(environment), "7")
    path.parent.mkdir(parents=True)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as left:
        left.bind(str(path))
    assert send_command(ReplayCommand("pause"), environment) == 0
    assert not path.exists()
