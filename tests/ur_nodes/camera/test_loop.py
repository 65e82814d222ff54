from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tests.ur_nodes.camera.fake_device import FakeCamera, make_jpeg

from ur_nodes.camera.capture import V4l2Camera
from ur_nodes.camera.loop import STALLED, CameraLoop
from ur_nodes.camera.model import CameraError, Frame, Mode, PictureSource, Settings

LIMIT = 30.0  # s


class Consumer:
    """Collects what the loop passes on, and waits for it."""

    wanted = True

    def __init__(self) -> None:
        self.changed = threading.Condition()
        self.events: list[str] = []

    def begin(self, mode: Mode) -> None:
        self.add(f"begin {mode.width}")

    def take(self, frame: Frame) -> None:
        self.add("picture" if frame.jpeg else "empty")

    def report(self, problem: CameraError) -> None:
        self.add(problem.reason)

    def add(self, event: str) -> None:
        with self.changed:
            self.events.append(event)
            self.changed.notify_all()

    def expect(self, count: int) -> list[str]:
        with self.changed:
            assert self.changed.wait_for(lambda: len(self.events) >= count, LIMIT), self.events
            return list(self.events)


@contextmanager
def running(open_camera: Callable[[], PictureSource], consumer: Consumer) -> Iterator[CameraLoop]:
    ended = threading.Event()
    loop = CameraLoop(open_camera, consumer, ended, try_every=0.01)
    thread = threading.Thread(target=loop.run)
    thread.start()
    try:
        yield loop
    finally:
        ended.set()
        loop.wake()
        thread.join(LIMIT)
        assert not thread.is_alive()


def opener(camera: FakeCamera) -> Callable[[], PictureSource]:
    def open_camera() -> PictureSource:
        try:
            return V4l2Camera(camera.open("/dev/video0"), "/dev/video0", Settings())
        except OSError as problem:
            raise CameraError(problem.strerror or "") from None

    return open_camera


def test_pictures_go_on_by_themselves_after_the_camera_was_unplugged() -> None:
    camera, consumer = FakeCamera(), Consumer()
    with running(opener(camera), consumer):
        consumer.expect(1)
        camera.feed(make_jpeg())
        consumer.expect(2)
        camera.unplug()
        consumer.expect(4)
        camera.plug()
        consumer.expect(5)
        camera.feed(make_jpeg())
        events = consumer.expect(6)
    lost = "the camera Fake Camera (/dev/video0) was unplugged"
    assert events == ["begin 640", "picture", lost, "No such file or directory", "begin 640", "picture"]
    assert [file.closed for file in camera.files] == [True, True]


def test_same_reason_is_reported_once() -> None:
    consumer, tries = Consumer(), []
    enough = threading.Event()

    def open_camera() -> PictureSource:
        tries.append(0)
        if len(tries) == 3:
            enough.set()
        raise CameraError("no camera")

    with running(open_camera, consumer):
        assert enough.wait(LIMIT)
    assert consumer.events == ["no camera"]


def test_pause_releases_the_camera_and_resume_takes_it_again() -> None:
    camera, consumer = FakeCamera(), Consumer()
    with running(opener(camera), consumer) as loop:
        consumer.expect(1)
        loop.pause()
        assert camera.user is None
        loop.resume()
        consumer.expect(2)
        assert camera.user is not None


def test_camera_that_falls_silent_is_opened_again() -> None:
    camera, consumer = FakeCamera(), Consumer()
    times = iter(range(0, 1000, round(STALLED)))
    ended = threading.Event()
    loop = CameraLoop(opener(camera), consumer, ended, clock=lambda: float(next(times)))
    thread = threading.Thread(target=loop.run)
    thread.start()
    events = consumer.expect(3)
    ended.set()
    thread.join(LIMIT)
    assert events[1] == "the camera Fake Camera (/dev/video0) has sent no picture for 5 s"
    assert events[2] == "begin 640"
