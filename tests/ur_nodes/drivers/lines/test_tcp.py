"""A device behind TCP: a lidar on Ethernet is opened, lost and opened again as one on a serial line."""

import socket
from collections.abc import Iterator
from contextlib import closing

import pytest
from tests.ur_nodes.drivers.lines.test_serial_line import Record
from tests.ur_nodes.drivers.threads import ThreadedNode

from ur_nodes.drivers.lines.line import LineSettings
from ur_nodes.drivers.lines.serial_line import SerialLine, open_port

SETTINGS = LineSettings(115200)


@pytest.fixture
def server() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as made:
        yield made


def address(server: socket.socket) -> str:
    return f"tcp://127.0.0.1:{server.getsockname()[1]}"


def test_bytes_go_both_ways(server: socket.socket) -> None:
    port = open_port(address(server), SETTINGS)
    assert isinstance(port, socket.socket)
    ours, _ = server.accept()
    with closing(port), closing(ours):
        port.sendall(b"VV\n")
        assert ours.recv(10) == b"VV\n"
        assert not port.getblocking()


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        ("tcp://", "no address of a device, expected tcp://HOST:PORT"),
        ("tcp://lidar", "no address of a device, expected tcp://HOST:PORT"),
        ("tcp://127.0.0.1:99999", "Port out of range 0-65535"),
    ],
)
def test_what_is_no_address_is_refused(path: str, reason: str) -> None:
    assert open_port(path, SETTINGS) == reason


def test_port_that_is_closed_is_reported(server: socket.socket) -> None:
    path = address(server)
    server.close()
    assert open_port(path, SETTINGS) == "connection refused"


def test_line_is_opened_again_after_the_device_has_closed_it(server: socket.socket) -> None:
    record = Record()
    line = SerialLine(ThreadedNode(), address(server), record.user(), SETTINGS)  # type: ignore[arg-type]
    for _ in range(2):
        ours, _ = server.accept()
        record.wait(lambda events: bool(events) and events[-1] == "open")
        with closing(ours):
            ours.sendall(b"scan")
            record.wait(lambda events: events[-1] == (b"scan", 7))
            line.write(b"QT\n")
            assert ours.recv(10) == b"QT\n"
        record.wait(lambda events: events[-1] == "it was unplugged")
    line.close()
