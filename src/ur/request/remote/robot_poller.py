"""Periodic queries of all robots in parallel: whether they answer, their nodes, services and clocks."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Collection, Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

from ur.request.remote.connection import list_node_names
from ur.robot.discovery.announcements import Announcement, Browser
from ur.robot.discovery.ask import ask_robot
from ur.robot.discovery.listing import RobotAnswer, is_settled
from ur.robot.discovery.record import DEFAULT_USER

SSH_PORT = 22
PERIOD = 5.0  # s after an answer until a robot is asked once more
STARTING_PERIOD = 0.3  # s, likewise, of a robot that is starting
SSH_SECONDS = 5.0  # a login on a small computer that has just booted takes seconds
AT_ONCE = 16


class RobotPoller:
    """Queries robots in the background while its context lasts. `changed` is called from other threads.

    `answers` has the latest answer of each, by its host name. No query takes longer than `seconds`, except those over
    ssh. `former` returns names under which an address was known before. Robots whose names are `known` have separate
    threads, so that they do not wait for many unknown ones that do not answer.
    """

    def __init__(
        self,
        browser: Browser,
        seconds: float,
        changed: Callable[[], None],
        former: Callable[[str], Sequence[str]] = lambda _: (),
        known: Collection[str] = (),
    ) -> None:
        self.answers: dict[str, RobotAnswer] = {}
        self._browser, self._seconds, self._changed, self._former = browser, seconds, changed, former
        self._known = frozenset(known)
        self._next: dict[str, float] = {}
        self._over = threading.Event()
        self._lock = threading.Lock()

    def __enter__(self) -> RobotPoller:
        self._pools = {is_known: ThreadPoolExecutor(AT_ONCE) for is_known in (True, False)}
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        for pool in self._pools.values():
            pool.shutdown(wait=False, cancel_futures=True)
        for pool in self._pools.values():
            pool.shutdown(wait=True)

    def ask(self, sightings: Iterable[Announcement]) -> None:
        """Query the robots that were not queried recently."""
        now = time.monotonic()
        for one in sightings:
            if one.address and self._next.get(one.host, 0.0) <= now:
                self._next[one.host] = float("inf")  # until this answer has arrived
                pool = self._pools[one.name in self._known]
                for question in (self._answers, self._nodes, self._services, self._twin):
                    pool.submit(question, one).add_done_callback(self._notify)

    def is_settled(self, sightings: Iterable[Announcement]) -> bool:
        """Return whether no more answers of these robots are expected soon; of many robots, those of the known ones."""
        waited = [one for one in sightings if one.address]
        if len(waited) > AT_ONCE:
            waited = [one for one in waited if one.name in self._known]
        return all(is_settled(self.answers.get(one.host, RobotAnswer())) for one in waited)

    def _answers(self, one: Announcement) -> None:
        answers = True
        try:
            socket.create_connection((one.address, SSH_PORT), timeout=self._seconds).close()
        except ConnectionRefusedError:
            pass  # an answer, too
        except OSError:
            answers = False
        self._note(one, answers=answers)

    def _nodes(self, one: Announcement) -> None:
        names = list_node_names(one.address, self._seconds)
        self._note(one, nodes=None if names is None else len(names))

    def _services(self, one: Announcement) -> None:
        login = f"{one.user or DEFAULT_USER}@{one.address}"
        names = dict.fromkeys((one.name, one.host, *self._former(one.address)))
        answer = ask_robot(login, [*names], max(self._seconds, SSH_SECONDS), time.time, self._over)
        self._note(
            one, services=answer.services, offset=answer.offset, refused=answer.refused, known_as=answer.known_as
        )
        settled = is_settled(self.answers[one.host])
        self._next[one.host] = time.monotonic() + (PERIOD if settled else STARTING_PERIOD)

    def _twin(self, one: Announcement) -> None:
        if one.host == one.name:  # else it is the twin itself
            self._note(one, twin=self._browser.find_twin(one.name, self._seconds))

    def _note(self, one: Announcement, **reported: object) -> None:
        with self._lock:
            before = self.answers.get(one.host, RobotAnswer())
            self.answers[one.host] = replace(before, **reported)  # type: ignore[arg-type] # keywords of this module

    def _notify(self, done: Future[None]) -> None:
        if not done.cancelled():
            self._changed()
