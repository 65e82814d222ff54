"""Beats of a node's loop, with a clock that a test moves."""

import threading
import time

import pytest
from tests.fakes.clock import ManualClock

from ur_nodes.loop import Beat, Beats, Loop, Worker


def take_all(beats: Beats) -> int:
    """The number of beats that are due."""
    count = 0
    while (call := beats.pop()) is not None:
        call()
        count += 1
    return count


def test_beat_repeats_without_drift_and_leaves_out_what_is_late() -> None:
    clock, got = ManualClock(), list[float]()
    beats = Beats(clock)
    beats.add(Beat(0.1, lambda: got.append(clock.now)))
    for _ in range(10):
        clock.now += 0.05
        take_all(beats)
    assert len(got) == 5
    clock.now += 10.0
    assert take_all(beats) <= 2


def test_new_beat_does_not_put_off_one_that_is_due_soon() -> None:
    clock, slow = ManualClock(), list[float]()
    beats = Beats(clock)
    beats.add(Beat(1.0, lambda: slow.append(clock.now)))
    for _ in range(210):
        beats.add(Beat(0.007, lambda: None, once=True))
        take_all(beats)
        clock.now += 0.01
        take_all(beats)
    assert len(slow) == 2


def test_beats_go_on_after_time_was_set_back() -> None:
    clock, got = ManualClock(), list[float]()
    beats = Beats(clock)
    beats.add(Beat(0.1, lambda: got.append(clock.now)))
    clock.now = 1000.0
    take_all(beats)
    clock.now = 0.0
    take_all(beats)
    before = len(got)
    clock.now = 0.15
    take_all(beats)
    assert len(got) == before + 1


def test_cancelled_beat_is_not_called() -> None:
    clock, got = ManualClock(), list[float]()
    beats = Beats(clock)
    beat = beats.add(Beat(0.1, lambda: got.append(clock.now)))
    beat.cancel()
    clock.now += 1.0
    take_all(beats)
    assert got == []


def test_what_is_asked_of_a_loop_is_done_before_and_after_its_end() -> None:
    loop, done = Loop(time.monotonic, steady=True), list[str]()
    loop.start()
    loop.ask(lambda: done.append("while it runs"), 60.0)
    loop.end(lambda: done.append("last"), 60.0)
    loop.ask(lambda: done.append("afterwards"), 60.0)
    assert done == ["while it runs", "last", "afterwards"]


def test_call_waits_for_no_more_of_a_flood_than_a_mailbox_holds() -> None:
    loop, taken, done = Loop(time.monotonic, steady=True), list[int](), threading.Event()

    def take(item: int) -> None:
        if not done.is_set():
            taken.append(item)
            put(item + 1)  # so it never becomes empty

    put = loop.mailbox(3, take)
    for item in range(1000):
        put(item)
    loop.post(done.set)
    loop.start()
    assert done.wait(60.0)
    loop.end(lambda: None, 60.0)
    assert taken == [997, 998, 999]


def test_beat_of_simulated_time_is_called_when_the_clock_arrives() -> None:
    clock, got = ManualClock(0.0), list[float]()
    called = threading.Semaphore(0)
    loop = Loop(clock, steady=False)

    def take() -> None:
        got.append(clock.now)
        called.release()

    loop.every(0.1, take)
    loop.start()
    for now in (0.05, 0.11, 0.15, 0.21):
        clock.now = now
        loop.passed()
        if now in (0.11, 0.21):
            assert called.acquire(timeout=60.0)
    clock.now = 0.01  # the simulator was started anew
    loop.passed()
    loop.ask(lambda: None, 60.0)
    clock.now = 0.12
    loop.passed()
    assert called.acquire(timeout=60.0)
    loop.end(lambda: None, 60.0)
    assert got == [0.11, 0.21, 0.12]


def test_last_call_is_made_when_an_exception_has_ended_the_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threading, "excepthook", lambda _details: None)
    loop, calls = Loop(time.monotonic, steady=True), list[str]()
    failed = threading.Event()
    loop.start(failed.set)

    def fail() -> None:
        raise ValueError("a callback fails")

    loop.post(fail)
    assert failed.wait(10.0)
    loop.end(lambda: calls.append("stop the robot"), 10.0)
    assert calls == ["stop the robot"]


def test_worker_ends_after_the_job_that_runs_and_forgets_the_others() -> None:
    worker, begun, go_on, done = Worker("work"), threading.Event(), threading.Event(), list[str]()

    def work() -> None:
        begun.set()
        go_on.wait()
        done.append("first")

    worker.add(work)
    worker.add(lambda: done.append("second"))
    begun.wait()
    worker.end()
    go_on.set()
    worker.join(60.0)
    assert done == ["first"]
