"""Symbolic links between folders: followed as ROS does, without cycles and without entering the kernel's files."""

# Paths are texts here, as in the modules that walk folders.
# ruff: noqa: PTH114, PTH118

from __future__ import annotations

import os
from collections.abc import Iterator

_KERNEL = ("/proc/", "/sys/", "/dev/")


class FollowedLinks:
    """The targets of symbolic links in one walk."""

    def __init__(self) -> None:
        self._targets: set[str] = set()

    def leads_on(self, path: str, folder: str) -> bool:
        """Return whether a link in a folder leads to a folder that the walk does not reach otherwise.

        rospack also follows links to parent folders, until the system refuses, and finds the same packages again.
        """
        target, here = os.path.realpath(path), os.path.realpath(folder)
        if target in self._targets or f"{here}/".startswith(target.rstrip("/") + "/"):
            return False
        self._targets.add(target)
        return not f"{target}/".startswith(_KERNEL)


def walk_links(top: str) -> Iterator[tuple[str, list[str], list[str]]]:
    """Walk as `os.walk` with `followlinks`; the caller may change the lists of folders as there."""
    links = FollowedLinks()
    for folder, folders, files in os.walk(top, followlinks=True):
        folders[:] = [
            name
            for name in folders
            if not os.path.islink(path := os.path.join(folder, name)) or links.leads_on(path, folder)
        ]
        yield folder, folders, files
