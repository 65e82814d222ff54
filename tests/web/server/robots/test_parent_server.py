import os

import pytest

from ur.source.diagnostic import UserError
from ur.web.server.robots.parent_server import IDLE_LIMIT, Idle, adopt_connection


def test_server_ends_when_no_page_was_connected_for_ten_minutes() -> None:
    idle = Idle(0.0)
    assert IDLE_LIMIT == 600.0
    assert not idle.is_over(600.0, connected=False)
    assert idle.is_over(600.1, connected=False)


def test_page_that_is_connected_or_invited_keeps_the_server() -> None:
    idle = Idle(0.0)
    assert not idle.is_over(5000.0, connected=True)
    assert not idle.is_over(5599.0, connected=False)
    idle.note(5599.0)
    assert not idle.is_over(6000.0, connected=False)
    assert idle.is_over(6200.0, connected=False)


def test_descriptor_that_is_no_socket_of_another_server_is_refused_and_left_open() -> None:
    read, write = os.pipe()
    try:
        for descriptor in (read, 987654, -1):
            with pytest.raises(UserError, match="expected a socket of the server"):
                adopt_connection(descriptor)
        os.fstat(read)
    finally:
        os.close(read)
        os.close(write)
