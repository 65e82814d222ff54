"""Diagnostics and figures of the computer, sent while a page shows them."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import rospy

from ur.web.wire.data_frames import pack_json
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.data.decode import BadMessageError, decode
from ur_nodes.web.data.definition import BadDefinitionError, read_definition
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.status.computer import CpuTimes, describe_computer, read_times, share_used
from ur_nodes.web.status.computer_files import read_computer, read_disk
from ur_nodes.web.status.diagnostics import BOUNDS, KIND, Diagnostics

_EVERY = 2.0  # s
_TOPIC = "/diagnostics"
_LONGEST = 1 << 20  # bytes of a message


class StatusFeed:
    """Sends what pages show. `subscribe` makes subscribers as rospy.Subscriber does."""

    def __init__(self, send: Callable[[bytes], None], subscribe: Callable[..., Any] = rospy.Subscriber) -> None:
        self._send, self._subscribe = send, subscribe
        self._every = Every(_EVERY)
        self._subscriber: Any = None
        self._diagnostics = Diagnostics()
        self._pages: Sequence[int] = ()
        self._times = CpuTimes()

    def step(self, now: float, pages: Collection[int]) -> None:
        """Send the state to these pages; to be called often, from one thread."""
        if pages and self._subscriber is None:
            self._subscriber = self._subscribe(_TOPIC, rospy.AnyMsg, self._take, queue_size=10, buff_size=_LONGEST)
        elif not pages and self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber, self._diagnostics, self._times = None, Diagnostics(), CpuTimes()
        if set(pages) - set(self._pages):
            self._every.hurry()
        self._pages = tuple(pages)
        if not pages or not self._every.due(now):
            return
        value = {"t": "status", "components": self._diagnostics.describe(time.monotonic()), "computer": self._measure()}
        for page in pages:
            self._send(pack_json(page, "status", value))

    def _measure(self) -> dict[str, Any]:
        texts = read_computer()
        before, self._times = self._times, read_times(texts.stat)
        master = urlsplit(os.environ.get("ROS_MASTER_URI", ""))
        found = {
            **describe_computer(texts),
            "name": socket.gethostname()[:60],
            "cpu": share_used(before, self._times),
            "disk": read_disk(Path.home()),
            "master": str(master.hostname or "")[:100],
            "link": _time_master(),
        }
        return {name: each for name, each in found.items() if each is not None}

    @quiet_at_end
    def _take(self, message: Any) -> None:
        header = message._connection_header  # noqa: SLF001 - rospy's own way to the type of AnyMsg
        data = bytes(message._buff)  # noqa: SLF001 - rospy's own way to the bytes of AnyMsg
        if header.get("type") != KIND or len(data) > _LONGEST:
            return
        try:
            found = decode(read_definition(KIND, str(header.get("message_definition", ""))), data, BOUNDS)
        except (BadDefinitionError, BadMessageError) as problem:
            rospy.logwarn_throttle(10.0, f"{_TOPIC}: {problem}")
            return
        self._diagnostics.take(found, time.monotonic())


def _time_master() -> float | None:
    """The milliseconds that the master takes to answer; None while it does not."""
    began = time.monotonic()
    try:
        rospy.get_master().getPid()
    except Exception:  # the master may answer anything
        return None
    return round(1000 * (time.monotonic() - began), 1)
