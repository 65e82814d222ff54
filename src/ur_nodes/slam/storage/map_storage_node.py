"""Stores the map of a mapping node: every few seconds, when somebody asks, and at the end."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace

import rospy
from std_srvs.srv import Trigger, TriggerRequest, TriggerResponse

from ur.maps.names import check_map_name, fresh_name
from ur.maps.record import MapRecord
from ur.maps.store import PICTURE, own_store
from ur_nodes.geometry.grid import Grid
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.slam.map_state import MapState
from ur_nodes.slam.storage.convert import load_poses
from ur_nodes.slam.storage.writer import MapWriter, pause_before_next

SILENCE = 30.0  # s between two reports of the same problem


@dataclass(frozen=True, slots=True)
class StorageSettings:
    """`name` of the map, '' for one that no map has; `every` (s) it is written; `robot` is who makes it.

    `latest`: it becomes the map that `latest` stands for.
    """

    name: str
    every: float
    robot: str
    latest: bool


def read_storage_settings(parameters: Parameters) -> StorageSettings | None:
    """Read the settings; None where the map is not to be stored. Raises UserError."""
    if not parameters.boolean("store", False):
        return None
    name = parameters.text("map_name", "")
    return StorageSettings(
        check_map_name(name) if name else "",
        parameters.number("save_every", 5.0, minimum=0.5, maximum=3600.0),
        parameters.text("robot", ""),
        parameters.boolean("latest", False),
    )


class MapStorage:
    """Holds the claim on a stored map until the node ends, and offers the service `~save`."""

    def __init__(
        self,
        settings: StorageSettings,
        state: Callable[[], MapState],
        draw: Callable[[MapState], Grid],
    ) -> None:
        """Claim the map. Raises UserError: another program changes it."""
        self._settings = settings
        self._store = own_store(os.environ)
        self.name = settings.name or fresh_name(time.strftime("%Y-%m-%d"), self._folders())
        self._state = state
        self._draw = draw
        self._claims = ExitStack()
        self._claims.enter_context(self._store.claim(self.name))
        record = self._store.record(self.name)
        self.continues = (self._store.path(self.name) / PICTURE).is_file()
        self._writer = MapWriter(self._store.path(self.name), replace(record, robot=settings.robot or record.robot))
        self._writing = threading.Lock()
        self._saved: MapState | None = None
        self._is_latest = False
        self._complained = 0.0

    def load(self) -> MapState:
        """Read the stored map. Raises UserError: it has a picture only, or is damaged."""
        poses, edges, scans = load_poses(self._store.path(self.name), self._writer.record)
        return MapState(poses, edges, scans)

    def start(self, stored: MapState | None = None) -> None:
        """Begin to store; `stored` is what is stored already; at the end of the node the map is written once more."""
        self._saved = stored
        rospy.Service("~save", Trigger, self._answer)
        rospy.on_shutdown(self._finish)
        threading.Thread(target=self._run, name="storage", daemon=True).start()

    def record(self) -> MapRecord:
        """The record of the stored map."""
        return self._writer.record

    def save(self) -> str:
        """Write the map if it has changed; returns what is wrong, '' when nothing is."""
        with self._writing:
            state = self._state()
            if not state.poses or _same(state, self._saved):
                return ""
            try:
                self._writer.write(self._draw(state), state.poses, state.edges, state.scans)
                if self._settings.latest and not self._is_latest:
                    self._store.set_latest(self.name)
                    self._is_latest = True
            except OSError as problem:
                return f"{problem.filename or self._store.path(self.name)}: {problem.strerror or problem}"
            self._saved = state
            return ""

    def _folders(self) -> list[str]:
        try:
            return [each.name for each in self._store.folder.iterdir()]
        except OSError:
            return []

    def _run(self) -> None:
        pause = self._settings.every
        while not rospy.core.is_shutdown_requested():
            time.sleep(pause)
            began = time.monotonic()
            self._report(self.save())
            pause = pause_before_next(self._settings.every, time.monotonic() - began)

    def _report(self, problem: str) -> None:
        if problem and time.monotonic() - self._complained > SILENCE:
            self._complained = time.monotonic()
            rospy.logerr("the map cannot be written: %s; is the disk full?", problem)

    def _answer(self, _request: TriggerRequest) -> TriggerResponse:
        problem = self.save()
        if not problem and self._saved is None:
            problem = "there is no map yet; is the lidar driver running?"
        return TriggerResponse(not problem, problem or self.name)

    def _finish(self) -> None:
        problem = self.save()
        if problem:
            rospy.logerr("the map cannot be written: %s", problem)
        elif self._saved is not None:
            rospy.loginfo("map '%s' saved; navigate on it with: ur run keyboard_navigate map:=%s", self.name, self.name)


def _same(state: MapState, saved: MapState | None) -> bool:
    if saved is None or len(state.scans) != len(saved.scans) or list(state.poses) != list(saved.poses):
        return False
    return all(one is other for one, other in zip(state.scans, saved.scans, strict=True))
