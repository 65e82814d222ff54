"""What robots say when they are asked, all at once and again and again, while they are listed."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

from ur.cli.master import list_node_names
from ur.robot.ask import ask_robot
from ur.robot.discovery import Browser, Sighting
from ur.robot.listing import Answer
from ur.robot.record import DEFAULT_USER

SSH_PORT = 22
AGAIN = 5.0  # s after an answer until a robot is asked once more
AT_ONCE = 16


class Asked:
    """Asks robots in the background while it is open; use as a context manager. `changed` is called from other threads.

    `answers` holds what each said last, by its host name. No question takes longer than `seconds`.
    """

    def __init__(self, browser: Browser, seconds: float, changed: Callable[[], None]) -> None:
        self.answers: dict[str, Answer] = {}
        self._browser, self._seconds, self._changed = browser, seconds, changed
        self._next: dict[str, float] = {}
        self._over = threading.Event()
        self._lock = threading.Lock()

    def __enter__(self) -> Asked:
        self._pool = ThreadPoolExecutor(AT_ONCE)
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._pool.shutdown(wait=True, cancel_futures=True)

    def ask(self, sightings: Iterable[Sighting]) -> None:
        """Ask those who were not asked lately."""
        now = time.monotonic()
        for one in sightings:
            if one.address and self._next.get(one.host, 0.0) <= now:
                self._next[one.host] = float("inf")  # until this answer is there
                for question in (self._answers, self._nodes, self._services, self._twin):
                    self._pool.submit(question, one).add_done_callback(self._notify)

    def _answers(self, one: Sighting) -> None:
        answers = True
        try:
            socket.create_connection((one.address, SSH_PORT), timeout=self._seconds).close()
        except ConnectionRefusedError:
            pass  # an answer, too
        except OSError:
            answers = False
        self._note(one, answers=answers)

    def _nodes(self, one: Sighting) -> None:
        names = list_node_names(one.address, self._seconds)
        self._note(one, nodes=None if names is None else len(names))

    def _services(self, one: Sighting) -> None:
        login = f"{one.user or DEFAULT_USER}@{one.address}"
        answer = ask_robot(login, one.name, self._seconds, time.time, self._over)
        self._note(one, services=answer.services, offset=answer.offset)
        self._next[one.host] = time.monotonic() + AGAIN

    def _twin(self, one: Sighting) -> None:
        if one.host == one.name:  # else it is the twin itself
            self._note(one, twin=self._browser.find_twin(one.name, self._seconds))

    def _note(self, one: Sighting, **said: object) -> None:
        with self._lock:
            before = self.answers.get(one.host, Answer())
            self.answers[one.host] = replace(before, **said)  # type: ignore[arg-type] # keywords of this module

    def _notify(self, done: Future[None]) -> None:
        if not done.cancelled():
            self._changed()
