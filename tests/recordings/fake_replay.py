"""A replay of two minutes as other processes see it: its socket, and the states that it answers."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from ur.recordings.datagrams import open_folder
from ur.recordings.replays import ReplayState, read_command, sockets_folder
from ur.source.foreign.json_values import write_json


class FakeReplay:
    """The state, and the commands that have changed it."""

    def __init__(self) -> None:
        self.state = ReplayState(3.0, 120.0, 1.0, playing=True, ended=False)
        self.commands: list[tuple[str, float]] = []

    def take(self, data: bytes) -> bytes:
        """Carry out a command; return the answer."""
        command = read_command(data)
        if command is None:
            return b"no command"
        if command.name != "state":
            self.commands.append((command.name, command.value))
        if command.name in ("play", "pause"):
            self.state = replace(self.state, playing=command.name == "play")
        elif command.name == "speed":
            self.state = replace(self.state, speed=command.value)
        elif command.name == "jump":
            self.state = replace(self.state, position=command.value)
        return write_json(self.state).encode()


@contextmanager
def fake_replay(folder: Path) -> Iterator[FakeReplay]:
    """Run a replay of the user whose XDG_STATE_HOME is a folder."""
    replay = FakeReplay()
    path = Path(sockets_folder({"XDG_STATE_HOME": str(folder)}), "7")
    path.parent.mkdir(parents=True, exist_ok=True)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as server, open_folder(str(path.parent)) as place:
        server.bind(f"{place}/{path.name}")

        def serve() -> None:
            while True:
                data, client = server.recvfrom(200)
                if not client:
                    return
                server.sendto(replay.take(data), client)

        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield replay
        finally:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as last:
                last.sendto(b"", f"{place}/{path.name}")
            thread.join()
            path.unlink()
