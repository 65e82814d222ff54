"""Calls of services whose server, or master, is away."""

from __future__ import annotations

import http.client
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from rospy.exceptions import TransportTerminated

from ur_nodes.loop import Loop
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result
from ur_nodes.ros1.services import call_service


@pytest.fixture
def loop() -> Iterator[Loop]:
    loop = Loop(time.monotonic, steady=True)
    loop.start()
    yield loop
    loop.end(lambda: None, 10.0)


class CallResults:
    """Results of calls."""

    def __init__(self) -> None:
        self.results: list[Result] = []
        self.arrived = threading.Event()

    def take(self, result: Result) -> None:
        self.results.append(result)
        self.arrived.set()


@pytest.mark.parametrize("problem", [TransportTerminated("unable to send"), http.client.BadStatusLine("")])
def test_server_that_ends_during_a_call_is_a_result(loop: Loop, problem: Exception) -> None:
    def fail(_request: Any) -> None:
        raise problem

    answers = CallResults()
    loop.post(lambda: call_service(loop, "cmd_vel_mux/stop", Trigger(), answers.take, 60.0, lambda *_: fail))
    assert answers.arrived.wait(60.0)
    assert not answers.results[0].success
    assert answers.results[0].text


def test_request_that_was_reported_as_failed_is_not_sent_later(loop: Loop) -> None:
    back, looked, sent = threading.Event(), threading.Event(), list[Any]()

    def find(*_: Any) -> Callable[[object], object]:
        back.wait(60.0)  # as a look-up does while the network is away
        looked.set()
        return sent.append

    answers = CallResults()
    loop.post(lambda: call_service(loop, "cmd_vel_mux/release", Trigger(), answers.take, 0.05, find))
    assert answers.arrived.wait(60.0)
    before = threading.enumerate()
    back.set()
    for thread in before:
        if thread.name == "call":
            thread.join(60.0)
    assert looked.is_set()
    assert sent == []
