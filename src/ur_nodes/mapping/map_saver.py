"""Saves received maps as files."""

import sys
from pathlib import Path

from ur.maps.picture_file import write_picture
from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.geometry.grid import Grid
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map


def save_map(name: Path, grid: Grid, occupied: int = 65, free: int = 25) -> Path:
    """Write `name`.pgm and `name`.yaml as `ur.maps.picture_file.write_picture` does; returns the latter.

    Raises OSError. The defaults (per cent) are upstream's.
    """
    origin = (grid.origin.x, grid.origin.y, grid.origin.yaw)
    return write_picture(name, grid.values, grid.resolution, origin, occupied, free)


PATIENCE = 15.0  # s until the log reports that there is no map, and between repetitions


class MapSaver:
    """Saves the first map that arrives, then ends the node; with `~keep` each one until the end.

    `failed` unless the last one was saved.
    """

    def __init__(self, node: Node, name: Path, occupied: int, free: int) -> None:
        self._node, self._name, self._limits = node, name, (occupied, free)
        self._keep = node.parameters.boolean("keep", False)
        self._received = self._reported = self._busy = False
        self._newest: Map | str | None = None  # received while another one was being saved
        self.failed = True
        node.subscribe("map", Map, self._on_map, Quality.LATCHED, unreadable=self._on_map)
        node.every(PATIENCE, self._explain_silence, steady=True)

    def _on_map(self, given: Map | str) -> None:
        """Take a map, or the reason why it cannot be read."""
        if self._busy or (self._received and not self._keep):
            self._newest = given
            return
        self._received = self._busy = self.failed = True
        self._node.work(lambda: self._save(given), self._finish)

    def _save(self, given: Map | str) -> tuple[str, str]:
        """Write a map; return the line to print, and the error, '' for none."""
        if isinstance(given, str):
            return "", f"error: {given}\n"
        try:
            file = save_map(self._name, given.grid, *self._limits)
        except UserError as problem:
            return "", render_human(problem.diagnostics)
        except OSError as problem:
            return "", f"error: map_saver: '{self._name}' cannot be written: {problem.strerror}\n"
        grid = given.grid
        return f"saved {grid.width} x {grid.height} cells of {grid.resolution:g} m as {file}\n", ""

    def _finish(self, found: tuple[str, str]) -> None:
        text, problem = found
        self._busy, self.failed = False, bool(problem)
        sys.stderr.write(problem)
        if text and not self._reported:
            self._reported = True
            sys.stdout.write(text)
            sys.stdout.flush()
        newest, self._newest = self._newest, None
        if not self._keep:
            self._node.end("done")
        elif newest:
            self._on_map(newest)

    def _explain_silence(self) -> None:
        if not self._received:
            topic = self._node.resolve("map")
            self._node.log.warn(f"no map on {topic} for {PATIENCE:g} s; is a mapping node running?")
