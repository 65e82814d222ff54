"""A recorder of ROS 1: connects to the publishers of topics, as rospy's subscribers do, but unknown to the master."""

import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from ur_nodes.loop import Loop, run_aside
from ur_nodes.ports.raw import RecordedMessage, RecordedTopic, RecordedType
from ur_nodes.ros1.recorder.receiver import (
    Address,
    LinkReceiver,
    TopicConnectionError,
    TopicLink,
    connect_topic,
    find_publisher,
)

_RETRY = 2.0  # s after a failure
_EARLY = 0.1  # s that a period may be shorter, as `record` is called about once a second

_Key = tuple[str, str]  # a topic, and a node that publishes it
_log = logging.getLogger("rosout")


@dataclass(slots=True)
class _State:
    """The state of a publisher of a topic; `link` is None while there is no connection."""

    busy: bool = False
    link: TopicLink | None = None
    next: float = 0.0


class RosRecorder:
    """See `ports.raw.TopicRecorder`. A topic with a period is connected for one message at a time."""

    def __init__(
        self,
        loop: Loop,
        name: str,
        callback: Callable[[Sequence[RecordedMessage]], None],
        clock: Callable[[], int],
        find: Callable[[str, str, str], Address] = find_publisher,
    ) -> None:
        """`name` is the node's own."""
        self._loop = loop
        self._find = find
        self._caller = f"{name}_recorder"  # publishers keep one connection for a name
        self._states: dict[_Key, _State] = {}
        self._addresses: dict[str, Address] = {}
        self._receiver = LinkReceiver(lambda batch: loop.post(lambda: callback(batch)), clock)

    def record(self, topics: Sequence[RecordedTopic]) -> None:
        now = time.monotonic()
        wanted = {(each.name, node): each.period for each in topics for node in each.publishers}
        for key in [key for key in self._states if key not in wanted]:
            link = self._states.pop(key).link
            if link is not None:
                self._receiver.drop(link)
        due: dict[str, list[tuple[str, bool]]] = {}
        for (topic, node), period in wanted.items():
            state = self._states.setdefault((topic, node), _State())
            if state.link is not None and state.link.once and not period:
                state.link.once = False
            if state.busy or now < state.next:
                continue
            state.busy = True
            state.next = now + max(0.0, period - _EARLY)
            due.setdefault(node, []).append((topic, period > 0.0))
        for node, each in due.items():
            run_aside(partial(self._connect, node, each))

    def close(self) -> None:
        self._states.clear()
        self._receiver.close()

    def _connect(self, node: str, topics: Sequence[tuple[str, bool]]) -> None:
        """Connect to topics of a node; on a thread of its own."""
        for topic, once in topics:
            self._connect_one((topic, node), once=once)

    def _connect_one(self, key: _Key, *, once: bool) -> None:
        try:
            link = self._open(key, once=once)
        except TopicConnectionError as problem:
            _log.debug("%s is not recorded: %s", key[0], problem)
            self._addresses.pop(key[1], None)
            self._loop.post(partial(self._ended, key, None, failed=True))
        else:
            self._loop.post(partial(self._begin, key, link))

    def _open(self, key: _Key, *, once: bool) -> TopicLink:
        topic, node = key
        known = self._addresses.get(node)
        try:
            address = known or self._find(self._caller, node, topic)
            sock, header = connect_topic(self._caller, address, topic)
        except TopicConnectionError:
            if known is None:
                raise
            address = self._find(self._caller, node, topic)  # it has been started again
            sock, header = connect_topic(self._caller, address, topic)
        self._addresses[node] = sock.getpeername()[:2]
        latched = header.get("latching") == "1"
        found = RecordedType(topic, header["type"], header.get("message_definition", ""), node, latched)
        link = TopicLink(sock, found, once and not latched, lambda: None)
        link.end = lambda: self._loop.post(partial(self._ended, key, link))
        return link

    def _begin(self, key: _Key, link: TopicLink) -> None:
        state = self._states.get(key)
        if state is None or state.link is not None:
            link.socket.close()  # it is not wanted any more, or was wanted twice
            return
        state.link = link
        self._receiver.add(link)

    def _ended(self, key: _Key, link: TopicLink | None, *, failed: bool = False) -> None:
        state = self._states.get(key)
        if state is not None and state.link is link:
            state.link, state.busy = None, False
            if failed:
                state.next = time.monotonic() + _RETRY
