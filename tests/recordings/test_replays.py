"""Commands to replays."""

import socket
from pathlib import Path

import pytest
from tests.recordings.fake_replay import fake_replay

from ur.recordings.replays import (
    ReplayCommand,
    ReplayState,
    ask_replay,
    describe_state,
    read_command,
    sockets_folder,
)
from ur.source.foreign.json_values import write_json

PAUSED = ReplayState(3.0, 120.0, 0.5, playing=False, ended=False)


@pytest.mark.parametrize("command", [ReplayCommand("pause"), ReplayCommand("jump", 12.25), ReplayCommand("speed", 0.5)])
def test_command_is_read_as_it_was_written(command: ReplayCommand) -> None:
    assert read_command(write_json(command).encode()) == command


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"jump",
        b'{"name": "rewind"}',
        b'{"name": "jump", "value": NaN}',
        b"\xff\xfe",
        b'{"name": "speed", "value": 1e999}',
    ],
)
def test_other_data_is_no_command(data: bytes) -> None:
    assert read_command(data) is None


def test_replay_that_was_killed_takes_nothing(tmp_path: Path) -> None:
    environment = {"XDG_STATE_HOME": str(tmp_path)}
    assert ask_replay(ReplayCommand("pause"), environment) is None
    path = Path(sockets_folder(environment), "7")
    path.parent.mkdir(parents=True)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as left:
        left.bind(str(path))
    assert ask_replay(ReplayCommand("pause"), environment) is None
    assert not path.exists()


def test_replay_answers_with_its_state(tmp_path: Path) -> None:
    environment = {"XDG_STATE_HOME": str(tmp_path)}
    with fake_replay(tmp_path) as replay:
        assert ask_replay(ReplayCommand("state"), environment) == replay.state
        paused = ask_replay(ReplayCommand("pause"), environment)
        assert paused is not None
        assert not paused.playing
        replay.take = lambda _: b"{}"  # type: ignore[method-assign,assignment]
        assert ask_replay(ReplayCommand("state"), environment) is None


def test_state_is_described() -> None:
    assert describe_state(PAUSED) == "paused at 3.0 of 120.0 s, speed 0.5"
