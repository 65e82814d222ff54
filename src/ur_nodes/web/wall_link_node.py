"""Walls of the map in use, for pages: the map server draws, erases and restores them on request."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import rospy
from std_msgs.msg import String

from ur.maps.names import is_map_name
from ur.web.wire.map_requests import DrawWalls, RestoreWalls
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.request_topic_node import Done, RequestTopic, read_answer

_LONGEST = 2000  # characters of the state


class WallLink:
    """Follows the map server, and passes changes on. Methods may be called from any thread."""

    def __init__(self, name: str) -> None:
        """`name` begins the ids of requests."""
        self._state = ("", False)
        self._topic = RequestTopic("wall_request", name)
        rospy.Subscriber("walls", String, self._on_walls, queue_size=1)

    def describe(self) -> Mapping[str, Any]:
        """Describe it for a page: `name` of the map whose walls can be changed; "" and `why` not."""
        if not self._topic.served():
            return {"name": "", "restorable": False, "why": "no server"}
        name, restorable = self._state
        return {"name": name, "restorable": restorable, "why": "" if name else "file"}

    def change(self, request: DrawWalls | RestoreWalls, done: Done) -> bool:
        """Ask for a change; `done` is called with what is wrong, or ''. Return False: no map server has walls."""
        value: dict[str, Any] = {"do": "restore", "map": request.map}
        if isinstance(request, DrawWalls):
            value = {"do": "draw", "map": request.map, "strokes": [asdict(each) for each in request.strokes]}
        return self._topic.ask(value, done)

    @quiet_at_end
    def _on_walls(self, message: String) -> None:
        found = _read(message.data)
        if found is None:
            rospy.logwarn_throttle(10.0, "walls: not what a map server publishes; they cannot be changed")
            return
        self._state, answer = found
        self._topic.take(answer)


def _read(text: str) -> tuple[tuple[str, bool], tuple[str, str] | None] | None:
    """Name and whether it can be restored, and id and problem of the last answer; None: the text is none of these."""
    if len(text) > _LONGEST:
        return None
    try:
        found = json.loads(text)
        name, answer = str(found["name"]), read_answer(found["answer"])
        return (name if is_map_name(name) else "", found["restorable"] is True), answer
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
