from __future__ import annotations

import threading

from ur_nodes.teleop.terminal.wake import Wake


def test_ring_wakes_once_however_often_it_was_rung() -> None:
    wake = Wake()
    assert not wake.wait(0.0)
    for _ in range(100_000):  # more than the pipe holds: it never blocks
        wake.ring()
    while wake.wait(0.0):
        pass
    assert not wake.clear()


def test_ring_of_another_thread_wakes() -> None:
    wake = Wake()
    thread = threading.Thread(target=wake.ring)
    thread.start()
    assert wake.wait(60.0)
    thread.join()
