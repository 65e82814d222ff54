"""The key that saves the map while it is made: a service call that keeps no other key waiting."""

from __future__ import annotations

import threading
from collections.abc import Callable

import rospy
from std_srvs.srv import Trigger

from ur.maps.names import is_map_name

HINT = "s saves the map"
_PATIENCE = 10.0  # s until a service that is not there counts as missing


class MapSaving:
    """Calls `save` aside, one call at a time, and keeps its answer as a line for the screen."""

    def __init__(self, save: Callable[[], str], hint: str = HINT) -> None:
        """`save` returns the line; it may take its time. `hint` is the first line."""
        self._save = save
        self._lock = threading.Lock()  # guards _news
        self._news = hint
        self._busy = threading.Semaphore()

    def ask(self) -> None:
        """Begin to save, unless a call is under way."""
        if self._busy.acquire(blocking=False):
            self._put("saving the map ...")
            threading.Thread(target=self._run, name="save", daemon=True).start()

    def take_news(self) -> str:
        """Return the newest line once; '' when there is none."""
        with self._lock:
            news, self._news = self._news, ""
        return news

    def _run(self) -> None:
        try:
            self._put(self._save())
        finally:
            self._busy.release()

    def _put(self, line: str) -> None:
        with self._lock:
            self._news = line


def call_save(service: str) -> str:
    """Call a service that saves the map; returns a line about it."""
    name, problem = save_map(service)
    return f"map '{name}' saved" if name else f"the map was not saved: {problem}"


def save_map(service: str) -> tuple[str, str]:
    """Call a service that saves the map; returns the name of the map, or '' and the reason."""
    try:
        rospy.wait_for_service(service, _PATIENCE)
        answer = rospy.ServiceProxy(service, Trigger)()
    except (rospy.ROSException, rospy.ServiceException) as problem:
        return "", str(problem)
    if not answer.success:
        return "", answer.message
    return (answer.message, "") if is_map_name(answer.message) else ("", "the service answers no name of a map")
