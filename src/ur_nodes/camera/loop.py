"""The loop of a camera: opens it, reads it, and tries again while it is missing."""

from collections.abc import Callable
from functools import partial
from typing import Generic, Protocol, TypeVar

from ur_nodes.camera.source import CameraError, Frame, Mode, PictureSource
from ur_nodes.ports.node import Node, Timer

STALLED = 5.0  # s without a picture, after which the camera is opened again
CAMERA = "camera"
"""The lane of all that uses the device."""

_READ_SECONDS = 0.5
_TRY_EVERY = 1.0  # s
_REPEAT = 30.0  # s between two reports of the same reason
_END_LIMIT = 5.0  # s: a camera that is being opened

Shot = TypeVar("Shot")
Made = TypeVar("Made")


class Consumer(Protocol[Shot]):
    """The receiver of a camera's pictures."""

    def ask(self) -> tuple[bool, Callable[[Frame], Shot]]:
        """Return whether the next picture is needed, and the function that prepares it on a worker.

        An empty picture is prepared, too.
        """

    def begin(self, mode: Mode) -> None:
        """Take note of a camera that was opened."""

    def on_shot(self, shot: Shot) -> None:
        """Take a picture that was read and prepared."""

    def report(self, problem: CameraError) -> None:
        """Report the reason why there are no pictures."""


class CameraLoop(Generic[Shot]):
    """Reads one camera until the node ends. `pause` releases the camera for other programs until `resume`."""

    def __init__(self, node: Node, open_camera: Callable[[], PictureSource], consumer: Consumer[Shot]) -> None:
        self._node, self._open, self._consumer = node, open_camera, consumer
        self._source: PictureSource | None = None
        self._busy = False  # a job is under way
        self._timer: Timer | None = None
        self._paused = False
        self._waiting: list[Callable[[], None]] = []  # until the camera is released
        self._reported: tuple[str, float] | None = None
        self._last = 0.0  # when a picture was read
        node.on_end(self._end, within=_END_LIMIT)

    def begin(self, first: PictureSource | CameraError) -> None:
        """Begin with an open camera, or with the reason why none is open."""
        self._on_opened(first)

    def pause(self, released: Callable[[], None]) -> None:
        """Release the camera, then call `released`."""
        self._paused = True
        if self._busy:
            self._waiting.append(released)
        else:
            released()

    def resume(self) -> None:
        """Open the camera again."""
        self._paused = False
        if not self._busy:
            self._try()

    def _try(self) -> None:
        if self._timer:
            self._timer.cancel()
        if not self._paused:
            self._work(partial(_attempt, self._open), self._on_opened)

    def _on_opened(self, opened: PictureSource | CameraError) -> None:
        if not isinstance(opened, CameraError):
            self._source, self._last = opened, self._node.steady()
            self._consumer.begin(opened.mode)
            self._read(opened)
            return
        self._report(opened)
        self._release()
        self._timer = self._node.after(_TRY_EVERY, self._try, steady=True)

    def _read(self, source: PictureSource) -> None:
        if self._paused:
            self._close(source)
            return
        wanted, develop = self._consumer.ask()

        def read() -> Shot | None:
            frame = source.read(_READ_SECONDS, wanted=wanted)
            return None if frame is None else develop(frame)

        self._work(partial(_attempt, read), partial(self._on_read, source))

    def _on_read(self, source: PictureSource, shot: Shot | CameraError | None) -> None:
        now = self._node.steady()
        if shot is None and now - self._last >= STALLED:
            mode = source.mode
            shot = CameraError(
                f"the camera {mode.camera} ({mode.path}) has sent no picture for {STALLED:.0f} s",
                "it is opened again; if that does not help, use another cable or port",
            )
        if isinstance(shot, CameraError):
            self._report(shot)
            self._close(source)
            return
        if shot is not None:
            self._reported, self._last = None, now
            self._consumer.on_shot(shot)
        self._read(source)

    def _close(self, source: PictureSource) -> None:
        self._source = None
        self._work(source.close, self._on_closed)

    def _on_closed(self, _closed: None) -> None:
        self._release()
        self._try()

    def _release(self) -> None:
        waiting, self._waiting = self._waiting, []
        for call in waiting:
            call()

    def _work(self, job: Callable[[], Made], callback: Callable[[Made], None]) -> None:
        def finish(made: Made) -> None:
            self._busy = False
            callback(made)

        self._busy = True
        self._node.work(job, finish, CAMERA)

    def _end(self) -> None:
        if self._source is not None:
            self._node.work(self._source.close, lambda _closed: None, CAMERA)

    def _report(self, problem: CameraError) -> None:
        now = self._node.steady()
        if self._reported and self._reported[0] == str(problem) and now - self._reported[1] < _REPEAT:
            return
        self._reported = (str(problem), now)
        self._consumer.report(problem)


def _attempt(job: Callable[[], Made]) -> Made | CameraError:
    try:
        return job()
    except CameraError as problem:
        return problem
