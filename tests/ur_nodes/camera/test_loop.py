from collections.abc import Callable

from tests.ur_nodes.camera.fake_device import FakeCamera, make_jpeg

from ur_nodes.camera.capture import V4l2Camera
from ur_nodes.camera.loop import CAMERA, STALLED, CameraLoop
from ur_nodes.camera.source import CameraError, CameraSettings, Frame, Mode, PictureSource
from ur_nodes.memory.bus import Bus

LOST = "the camera Fake Camera (/dev/video0) was unplugged"


class Consumer:
    """Collects what the loop passes on."""

    def __init__(self) -> None:
        self.events: list[str] = []

    def ask(self) -> tuple[bool, Callable[[Frame], str]]:
        return True, lambda frame: "picture" if frame.jpeg else "empty"

    def begin(self, mode: Mode) -> None:
        self.events.append(f"begin {mode.width}")

    def on_shot(self, shot: str) -> None:
        self.events.append(shot)

    def report(self, problem: CameraError) -> None:
        self.events.append(problem.reason)


class CameraLoopStage:
    """A loop on a bus, where each use of the camera takes 0.5 s."""

    def __init__(self, open_camera: Callable[[], PictureSource] | None = None) -> None:
        self.bus, self.consumer = Bus(), Consumer()
        self.camera = FakeCamera(patient=False)
        self.bus.durations[CAMERA] = 0.5
        self.node = self.bus.node("camera")
        opener = open_camera or self.open
        self.loop = CameraLoop(self.node, opener, self.consumer)
        try:
            self.loop.begin(opener())
        except CameraError as problem:
            self.loop.begin(problem)

    def open(self) -> PictureSource:
        try:
            return V4l2Camera(self.camera.open("/dev/video0"), "/dev/video0", CameraSettings())
        except OSError as problem:
            raise CameraError(problem.strerror or "") from None

    def run(self, seconds: float) -> list[str]:
        """What was passed on meanwhile."""
        self.consumer.events.clear()
        self.bus.run(seconds)
        return list(self.consumer.events)


def test_pictures_go_on_by_themselves_after_the_camera_was_unplugged() -> None:
    stage = CameraLoopStage()
    stage.camera.feed(make_jpeg())
    assert stage.run(2.0) == ["picture"]
    stage.camera.unplug()
    assert stage.run(5.0) == [LOST, "No such file or directory"]
    stage.camera.plug()
    assert stage.run(3.0) == ["begin 640"]
    stage.camera.feed(make_jpeg())
    assert stage.run(2.0) == ["picture"]
    assert [file.closed for file in stage.camera.files] == [True, False]


def test_same_reason_is_reported_again_after_half_a_minute_only() -> None:
    def open_camera() -> PictureSource:
        raise CameraError("no camera")

    stage = CameraLoopStage(open_camera)
    assert stage.consumer.events == ["no camera"]
    assert stage.run(29.0) == []
    assert stage.run(5.0) == ["no camera"]


def test_pause_releases_the_camera_and_resume_takes_it_again() -> None:
    stage = CameraLoopStage()
    done: list[str] = []
    stage.loop.pause(lambda: done.append("released"))
    assert stage.camera.user is not None
    assert stage.run(2.0) == []
    assert done == ["released"]
    assert stage.camera.user is None
    stage.loop.pause(lambda: done.append("again"))
    assert done == ["released", "again"]
    stage.loop.resume()
    assert stage.run(2.0) == ["begin 640"]
    assert stage.camera.user is not None


def test_pause_and_resume_while_the_camera_is_away_leave_one_loop() -> None:
    stage = CameraLoopStage()
    stage.camera.unplug()
    stage.run(1.2)
    done: list[str] = []
    stage.loop.pause(lambda: done.append("released"))
    stage.run(3.0)
    assert done == ["released"]
    stage.camera.plug()
    assert stage.run(3.0) == []
    stage.loop.resume()
    stage.loop.resume()
    assert stage.run(3.0) == ["begin 640"]
    assert stage.camera.opened == 2


def test_camera_that_falls_silent_is_opened_again() -> None:
    stage = CameraLoopStage()
    assert stage.run(STALLED + 2.0) == [
        "the camera Fake Camera (/dev/video0) has sent no picture for 5 s",
        "begin 640",
    ]


def test_camera_is_released_at_the_end_of_the_node() -> None:
    stage = CameraLoopStage()
    stage.run(1.0)
    stage.node.end("done")
    assert stage.camera.user is None
    assert stage.camera.files[0].closed
