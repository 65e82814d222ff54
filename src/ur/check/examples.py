"""Rules' own examples as packages in memory: tests check them, pages show them."""

from __future__ import annotations

from ur.check.model import Example
from ur.check.run import Report, check_paths
from ur.launchfile.world import MemoryWorld

FOLDER = "/ws/my_robot"
_OTHERS = {
    "/opt/demo_nodes/package.xml": "<package><name>demo_nodes</name></package>",
    "/opt/demo_nodes/bin/talker": "#!/bin/sh\n",
    "/opt/demo_nodes/bin/listener": "#!/bin/sh\n",
    "/opt/rviz/package.xml": "<package><name>rviz</name></package>",
    "/opt/rviz/bin/rviz": "#!/bin/sh\n",
}
_PACKAGES = {"my_robot": FOLDER, "demo_nodes": "/opt/demo_nodes", "rviz": "/opt/rviz"}
_EXECUTABLES = ("/opt/demo_nodes/bin/talker", "/opt/demo_nodes/bin/listener", "/opt/rviz/bin/rviz")
OPEN, CLOSE = "«", "»"


def check_example(example: Example) -> Report:
    """Apply all rules to an example."""
    files = {f"{FOLDER}/package.xml": "<package><name>my_robot</name></package>", **_OTHERS}
    files |= {_place(path): strip_marks(text) for path, text in example.files.items()}
    executables = (*_EXECUTABLES, *map(_place, example.executables))
    return check_paths([FOLDER], MemoryWorld(files, _PACKAGES, example.environment, executables))


def marked_place(example: Example) -> tuple[str, int, int] | None:
    """Path, start and end of what stands between the marks of a bad example."""
    for path, text in example.files.items():
        if OPEN in text:
            start = text.index(OPEN)
            return _place(path), start, text.index(CLOSE) - 1
    return None


def strip_marks(text: str) -> str:
    """An example's text as the checker reads it."""
    return text.replace(OPEN, "").replace(CLOSE, "")


def _place(path: str) -> str:
    return path if path.startswith("/") else f"{FOLDER}/{path}"
