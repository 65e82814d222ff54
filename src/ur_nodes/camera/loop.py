"""Keeps a camera's pictures coming: opens it, reads it, and tries again for as long as it is away."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Protocol

from ur_nodes.camera.model import CameraError, Frame, Mode, PictureSource

STALLED = 5.0  # s without a picture, after which the camera is opened anew
_READ_SECONDS = 0.5
_TRY_EVERY = 1.0  # s
_REPEAT = 30.0  # s between two reports of the same reason


class Consumer(Protocol):
    """Takes the pictures; called in the loop's thread."""

    @property
    def wanted(self) -> bool:
        """True while somebody wants pictures."""

    def begin(self, mode: Mode) -> None:
        """A camera was opened."""

    def take(self, frame: Frame) -> None:
        """A picture has come; an empty one where none was wanted."""

    def report(self, problem: CameraError) -> None:
        """There are no pictures, for this reason."""


class CameraLoop:
    """Reads one camera until `ended` is set. `pause` and `resume` release it for others and take it again."""

    def __init__(
        self,
        open_camera: Callable[[], PictureSource],
        consumer: Consumer,
        ended: threading.Event,
        clock: Callable[[], float] = time.monotonic,
        try_every: float = _TRY_EVERY,
    ) -> None:
        self._try_every = try_every
        self._open, self._consumer, self._ended, self._clock = open_camera, consumer, ended, clock
        self._changed = threading.Condition()
        self._paused = False
        self._holds = False
        self._reported: tuple[str, float] | None = None

    def pause(self) -> None:
        """Release the camera; returns when that is done."""
        with self._changed:
            self._paused = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._holds or self._ended.is_set(), 10.0)

    def resume(self) -> None:
        """Take pictures again."""
        with self._changed:
            self._paused = False
            self._changed.notify_all()

    def wake(self) -> None:
        """Have the loop notice at once that `ended` is set."""
        with self._changed:
            self._changed.notify_all()

    def run(self, first: PictureSource | None = None) -> None:
        """Read until the end; `first` is a camera that is open already."""
        source = first
        while not self._ended.is_set():
            if source is None and (self._wait_while_paused() or (source := self._try()) is None):
                continue
            with self._changed:
                self._holds = True
            try:
                self._read(source)
            except CameraError as problem:
                self._report(problem)
            finally:
                source.close()
                source = None
                with self._changed:
                    self._holds = False
                    self._changed.notify_all()

    def _read(self, source: PictureSource) -> None:
        """Read until the end or a pause. Raises CameraError."""
        self._consumer.begin(source.mode)
        last = self._clock()
        while not self._ended.is_set() and not self._paused:
            frame = source.read(_READ_SECONDS, wanted=self._consumer.wanted)
            now = self._clock()
            if frame is not None:
                self._reported, last = None, now
                self._consumer.take(frame)
            elif now - last >= STALLED:
                mode = source.mode
                raise CameraError(
                    f"the camera {mode.camera} ({mode.path}) has sent no picture for {STALLED:.0f} s",
                    "it is opened again; if that does not help, use another cable or port",
                )

    def _try(self) -> PictureSource | None:
        try:
            return self._open()
        except CameraError as problem:
            self._report(problem)
            with self._changed:
                self._changed.wait_for(lambda: self._ended.is_set() or self._paused, self._try_every)
            return None

    def _wait_while_paused(self) -> bool:
        """Wait for the end of a pause; False where there is none."""
        with self._changed:
            if not self._paused:
                return False
            self._changed.wait_for(lambda: self._ended.is_set() or not self._paused)
            return True

    def _report(self, problem: CameraError) -> None:
        now = self._clock()
        if self._reported and self._reported[0] == str(problem) and now - self._reported[1] < _REPEAT:
            return
        self._reported = (str(problem), now)
        self._consumer.report(problem)
