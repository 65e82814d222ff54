"""Make docs/images/launch.svg: the interface of `ur launch` over a run that stands still.

Usage: tools/make_launch_screenshot.py [OUTPUT] [COLUMNSxROWS] [dark|light]. The same input gives the same file.
"""

import asyncio
import socket
import sys
from collections.abc import Sequence
from pathlib import Path

from ur.run.clients.client import RunClient
from ur.run.clients.protocol import (
    NodeChanged,
    NodeReadiness,
    NodeStats,
    Notice,
    OutputLine,
    RunEvent,
    RunStarted,
    StatsSampled,
    find_severity,
)
from ur.run.clients.run_state import NodeRow
from ur.run.debugger.choice import DebuggerCommand
from ur.tui.app import WatchApp

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tools.pictures import IMAGES, clean_svg, read_size, save

NOW = 1_700_049_600.0
NODES = (
    ("simulator", 0.38, 142e6),
    ("robot_state_publisher", 0.02, 11e6),
    ("map_server", 0.0, 24e6),
    ("amcl", 0.09, 47e6),
    ("move_base", 0.16, 63e6),
)
LINES = (
    (-41, "simulator", "[INFO] [1.0]: World maze, robot magni at 0.00 0.00 0.00"),
    (-41, "map_server", "[ INFO] [1.0]: Read a 420 X 280 map at 0.05 m/cell"),
    (-40, "amcl", "[ INFO] [1.0]: Waiting for the map"),
    (-40, "amcl", "[ INFO] [1.0]: Received a 420 X 280 map"),
    (-39, "move_base", "[ INFO] [1.0]: Ready for goals"),
    (-24, "move_base", "[ INFO] [1.0]: Goal 12.00 -6.00 90, 17.3 m to go"),
    (-12, "amcl", "[ WARN] [1.0]: The scan fits the map badly"),
    (-11, "amcl", "[ WARN] [1.1]: The scan fits the map badly"),
    (-10, "amcl", "[ WARN] [1.2]: The scan fits the map badly"),
    (-6, "camera", "opening /dev/video0"),
    (-6, "camera", "Traceback (most recent call last):"),
    (-6, "camera", '  File "/home/you/ws/src/camera/nodes/camera_node", line 7, in <module>'),
    (-6, "camera", "    import cv2"),
    (-6, "camera", "ModuleNotFoundError: No module named 'cv2'"),
)
DEATH = (
    "error: /camera died: exit code 1\n"
    "  log: ~/.ros/log/latest/camera-7-stdout.log\n"
    "  try: install the Python package that has 'cv2': apt-cache search python3-cv2"
)
LATER = ((-3, "move_base", "[ INFO] [1.0]: The goal is reached"),)


class StillServices:
    """Services that do nothing."""

    def __init__(self) -> None:
        self.time = NOW

    def now(self) -> float:
        """As it was set."""
        return self.time

    def has_content(self, path: str) -> bool:
        """There are no logs here."""
        return bool(path)

    def find_pager(self) -> list[str] | None:
        """None."""
        return None

    def run_here(self, _words: Sequence[str]) -> str:
        """Nothing."""
        return ""

    def run_beside(self, _words: Sequence[str]) -> str:
        """Nothing."""
        return ""

    def debug(self, _row: NodeRow) -> DebuggerCommand | str:
        """Nothing."""
        return ""


def make_state() -> list[RunEvent]:
    """How the run stands."""
    events: list[RunEvent] = [
        RunStarted("m_navigate.77", 77, "m_navigate", "http://localhost:11311", "/logs", NOW - 41),
        *(NodeChanged(f"/{name}", "running", pid=number) for number, (name, _, _) in enumerate(NODES, 10)),
        NodeChanged("/camera", "ended", exit_code=1),
        NodeChanged("/lidar", "running", pid=30, restarts=2),
        NodeChanged("/master", "running", pid=8, core=True),
        NodeChanged("/rosout", "running", pid=9, core=True),
        *(NodeReadiness(f"/{name}", ready=True) for name, _, _ in NODES),
        NodeReadiness("/lidar", ready=False, missing=("topic /scan_lidar has no publisher",)),
    ]
    used = [NodeStats(f"/{name}", cpu, int(memory)) for name, cpu, memory in NODES]
    used += [NodeStats("/lidar", 0.01, 9_000_000), NodeStats("/master", 0.01, 33_000_000)]
    return [*events, StatsSampled((*used, NodeStats("/rosout", 0.0, 12_000_000)))]


async def take_screenshot(size: tuple[int, int], light: bool) -> str:
    """The screen as SVG."""
    ours, theirs = socket.socketpair()
    services = StillServices()
    with ours, RunClient(theirs) as control:
        app = WatchApp(control, services, light=light)
        async with app.run_test(size=size) as pilot:
            app.show_events(make_state())
            for when, name, text in (*LINES, (-6, "", DEATH), *LATER):
                services.time = NOW + when
                said = OutputLine(f"/{name}", "out", find_severity(text), text) if name else Notice("error", text)
                app.show_events([said])
            services.time = NOW
            app.show_events([])
            for _ in range(3):
                await pilot.press("down")
            await pilot.pause(0.2)
            picture = app.export_screenshot(title="ur launch", simplify=True)
    return clean_svg(picture)


def main() -> None:
    """Write the picture."""
    size, light = read_size(sys.argv[2:], "104x34")
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES / "launch.svg"
    save(asyncio.run(take_screenshot(size, light)), target)


if __name__ == "__main__":
    main()
