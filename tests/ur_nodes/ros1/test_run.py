from __future__ import annotations

import os
import signal
import threading

import pytest

from ur_nodes.ros1.run import shut_down_aside


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_during_registration_shuts_down_in_a_thread_of_its_own(number: signal.Signals) -> None:
    asked: list[tuple[str, str]] = []
    done = threading.Event()

    def shut_down(reason: str) -> None:
        asked.append((reason, threading.current_thread().name))
        done.set()

    before = signal.getsignal(number)
    with shut_down_aside(shut_down):
        os.kill(os.getpid(), number)
        assert done.wait(60.0)  # the main thread goes on meanwhile
    assert asked == [(f"signal-{number.value}", "shutdown")]
    assert signal.getsignal(number) is before


def test_handlers_are_put_back_after_an_error() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(ValueError, match="oops"), shut_down_aside():
        raise ValueError("oops")
    assert signal.getsignal(signal.SIGTERM) is before
