"""Replays: what is published at which time, pauses, speeds and jumps, without a node and on a bus."""

import socket
from pathlib import Path

import pytest
from tests.recordings.test_mcap_file import BEGIN, write_recording

from ur.recordings.datagrams import send_to_all
from ur.recordings.mcap_file import StoredMessage, open_recording
from ur.recordings.replays import CommandName, ReplayCommand, ReplayState, sockets_folder
from ur.source.diagnostic import UserError
from ur.source.foreign.json_values import read_json, write_json
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.raw import RawMessage
from ur_nodes.replay.playback import Player, ReplayNode

STRING = "std_msgs/String"


class Played:
    """A player, and the numbers of the words that it has sent."""

    def __init__(self, folder: Path, speed: float = 1.0) -> None:
        recording = open_recording(write_recording(folder / "one.mcap"))
        self.player = Player(recording, recording.topics.keys(), 100.0, speed=speed)
        self.words: list[int] = []

    def send(self, message: StoredMessage) -> None:
        if message.topic.name == "/words":
            self.words.append(int(message.data))

    def step(self, now: float) -> list[int]:
        self.words = []
        self.player.step(now, self.send)
        return self.words


def test_messages_are_sent_when_they_are_due(tmp_path: Path) -> None:
    played = Played(tmp_path)
    assert played.step(99.0) == []
    assert played.step(100.35) == [0, 1, 2, 3]
    assert played.step(100.95) == [4, 5, 6, 7, 8, 9]
    assert played.player.time == pytest.approx(BEGIN + 950_000_000, abs=1000)


def test_speed_and_pause_hold_from_the_position_on(tmp_path: Path) -> None:
    played = Played(tmp_path, speed=10.0)
    assert played.step(100.055) == [0, 1, 2, 3, 4, 5]
    played.player.pause()
    assert played.step(105.0) == []
    played.player.play()
    played.player.set_speed(0.5)
    assert played.step(105.2) == [6]
    played.player.set_speed(1e9)
    assert played.player.state.speed == 100.0


def test_jump_sends_the_map_first(tmp_path: Path) -> None:
    played = Played(tmp_path)
    assert [each.data for each in played.player.jump(10.0)] == [b"map"]
    assert played.step(100.15) == [100, 101]
    assert played.player.jump(0.0) == []
    assert played.step(100.26) == [0, 1]
    played.player.jump(1e6)
    assert played.player.state.position == pytest.approx(19.9)


def test_end_is_reached_and_play_begins_again(tmp_path: Path) -> None:
    played = Played(tmp_path, speed=100.0)
    assert len(played.step(101.0)) == 200
    assert played.player.state.ended
    assert played.step(102.0) == []
    played.player.play()
    assert played.step(102.0015) == [0, 1]


def command(folder: Path, name: CommandName, value: float = 0.0, sender: socket.socket | None = None) -> int:
    """Send a command to the replays of a user; the number of those that take it."""
    path = sockets_folder({"XDG_STATE_HOME": str(folder)})
    return send_to_all(path, write_json(ReplayCommand(name, value)).encode(), sender)


def test_node_publishes_a_recording_with_its_clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    bus = Bus()
    bus.schemas[STRING] = "string data\n"
    bus.parameters["/replay/recording"] = str(write_recording(tmp_path / "one.mcap"))
    heard: list[bytes] = []
    listener = bus.node("listener")
    listener.raw.subscribe("words", lambda message: heard.append(message.data))
    node = bus.node("replay")
    ReplayNode(node)
    bus.run(4.05)
    assert heard[:3] == [b"0", b"1", b"2"]
    assert len(heard) == pytest.approx(21, abs=1)
    maps: list[RawMessage] = []
    from ur_nodes.ports.qualities import Quality

    listener.raw.subscribe("map", maps.append, Quality.LATCHED)
    bus.run(0.1)
    assert [each.data for each in maps] == [b"map"]
    assert command(tmp_path, "jump", 15.0) == 1
    assert command(tmp_path, "pause") == 1
    heard.clear()
    bus.run(1.0)
    assert len(heard) <= 2
    assert command(tmp_path, "play") == 1
    assert command(tmp_path, "back", 5.0) == 1
    bus.run(0.5)
    assert int(heard[-1]) == pytest.approx(105, abs=3)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as client:
        client.bind("")
        client.settimeout(10.0)
        assert command(tmp_path, "speed", 2.0, client) == 1
        bus.run(0.1)
        state = read_json(client.recv(1000), ReplayState)
    assert (state.speed, state.playing) == (2.0, True)
    assert state.length == pytest.approx(19.9)
    node.end("test")
    assert command(tmp_path, "play") == 0


def test_node_without_a_recording_ends() -> None:
    with pytest.raises(UserError, match="without a recording"):
        ReplayNode(Bus().node("replay"))
