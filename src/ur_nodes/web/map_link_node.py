"""The stored map of the robot's programs, for pages: its name, and the service that saves one that is being made."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any

import rospy

from ur.source.printable import printable
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.teleop.navigator.map_saving_node import save_map
from ur_nodes.web.map_names import choose_name, choose_service
from ur_nodes.web.wall_link_node import WallLink

_KEEPER = "keyboard_navigate"
_SERVER = "static_map"  # the service of the map server, which runs where the keeper is left out, too
_SAVERS = (_KEEPER, "teleop_twist_keyboard", "explore")  # nodes with the parameter `save_service`
_PERIOD = 3.0  # s

Done = Callable[[str, str], None]


class MapLink:
    """Follows the parameters of programs from a thread of its own. Methods may be called from any thread."""

    def __init__(self, name: str) -> None:
        """`name` begins the ids of requests."""
        self.walls = WallLink(name)
        self._known = ("", "")  # name of the map, and service that saves it
        self._busy = threading.Semaphore()
        self._ended = threading.Event()
        rospy.on_shutdown(self._ended.set)
        threading.Thread(target=self._run, name="map link", daemon=True).start()

    def describe(self) -> Mapping[str, Any]:
        """Describe it for a page: `name` of the stored map in use, "" for none; `saves`: one is being made; `walls`."""
        name, service = self._known
        found = {"name": "", "restorable": False, "why": "made"} if service else self.walls.describe()
        return {"name": name, "saves": service != "", "walls": found}

    def save(self, done: Done) -> None:
        """Save the map that is being made; `done` is called with its name, or with "" and what is wrong."""
        service = self._known[1]
        if not service:
            done("", "no map")
        elif not self._busy.acquire(blocking=False):
            done("", "busy")
        else:
            threading.Thread(target=self._save, args=(service, done), name="save", daemon=True).start()

    def _save(self, service: str, done: Done) -> None:
        try:
            name, problem = save_map(service)
        finally:
            self._busy.release()
        done(name, "" if name else printable(problem)[:300] or "the service gives no reason")

    @quiet_at_end
    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self._known = self._ask()
            except Exception as problem:  # a master that does not answer has changed nothing
                rospy.logdebug("map link: %s", problem)
            self._ended.wait(_PERIOD)

    def _ask(self) -> tuple[str, str]:
        master = rospy.get_master()
        service = choose_service([rospy.get_param(f"{each}/save_service", "") for each in _SAVERS])
        if service:  # parameters stay when their node has ended
            service = rospy.resolve_name(service)
            service = service if master.lookupService(service)[0] == 1 else ""
        name = choose_name(rospy.get_param(f"{_KEEPER}/map_name", ""), made=service != "")
        if name and master.lookupService(rospy.resolve_name(_SERVER))[0] != 1:
            name = ""
        return name, service
