"""Reports to black boxes that run, and to those that were killed."""

import socket
from pathlib import Path

from ur.recordings.black_boxes import notify_black_boxes, recordings_folder, sockets_folder


def test_recordings_are_in_the_state_folder() -> None:
    assert recordings_folder({"HOME": "/home/robot"}) == "/home/robot/.local/state/ur/black_box"


def test_socket_of_a_node_that_was_killed_is_removed(tmp_path: Path) -> None:
    environment = {"XDG_STATE_HOME": str(tmp_path)}
    path = Path(sockets_folder(environment), "7")
    path.parent.mkdir(parents=True)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as left:
        left.bind(str(path))
    assert notify_black_boxes(environment, "/camera died") == 0
    assert not path.exists()
