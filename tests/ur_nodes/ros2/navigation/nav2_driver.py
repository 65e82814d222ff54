"""Drives a robot on which Nav2 runs by what the page and the terminal use. Prints what they would show as JSON."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

from ur_nodes.client.navigation import Names, NavigationTopics
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.run import run

_LOOK = 0.02  # s
_PATIENCE = 60.0  # s
_HERE = Path(__file__).parent


class Nav2Driver:
    """Goes through `_steps`: each yields a condition that is waited for."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._topics = NavigationTopics(node, Names())
        self._sent = 0
        self._server = self._start()
        self._found: dict[str, object] = {}
        self._progress = self._steps()
        self._condition: Callable[[], bool] = lambda: True
        node.every(_LOOK, self._look, steady=True)
        node.after(_PATIENCE, lambda: self._finish(f"waited for {_PATIENCE:g} s"), steady=True)
        node.on_end(lambda: self._server.kill())

    def _steps(self) -> Iterator[Callable[[], bool]]:
        yield self._is_ready
        for name, x in (("reached", 3.0), ("given up", -3.0), ("refused", -20.0)):
            self._send(x)
            yield lambda: self._topics.goal().over
            self._note(name)
        self._send(9.0)
        yield lambda: self._state() == "driving"
        yield lambda: self._topics.goal().recoveries == 2
        self._note("driving")
        yield lambda: self._topics.snapshot().path is not None
        self._topics.cancel_goals()
        yield lambda: self._topics.goal().over
        self._note("cancelled")
        self._send(9.0)
        yield lambda: self._state() == "driving"
        self._send(2.0)
        yield lambda: self._topics.goal().over
        self._note("replacing")
        stranger = subprocess.Popen([sys.executable, str(_HERE / "nav2_client.py"), "leave"], env=dict(os.environ))
        yield lambda: self._state() == "driving"
        self._note("of another client")
        stranger.kill()
        stranger.wait()
        self._topics.cancel_goals()
        yield lambda: self._topics.goal().over
        self._note("of another client, cancelled")
        self._send(9.0)
        yield lambda: self._state() == "driving"
        self._server.send_signal(signal.SIGKILL)
        self._server.wait()
        yield (
            lambda: self._state() == "unknown" and any("navigation" in each for each in self._topics.snapshot().missing)
        )
        self._server = self._start()
        yield lambda: self._topics.goal().over
        self._note("after a restart")
        yield self._is_ready
        self._send(1.0)
        yield lambda: self._topics.goal().over
        self._note("reached again")

    def _start(self) -> subprocess.Popen[bytes]:
        return subprocess.Popen([sys.executable, str(_HERE / "nav2_server.py")], env=dict(os.environ))

    def _send(self, x: float) -> None:
        self._sent += 1
        self._topics.send_goal(f"goal-{self._sent}", Pose2(x, 0.0, 0.0))

    def _state(self) -> str:
        return self._topics.goal().state.value

    def _is_ready(self) -> bool:
        return not any("navigation" in each for each in self._topics.snapshot().missing)

    def _note(self, name: str) -> None:
        goal = self._topics.goal()
        self._found[name] = [goal.state.value, goal.text, goal.pose and goal.pose.x, goal.recoveries]

    def _look(self) -> None:
        if self._condition():
            self._condition = next(self._progress, self._stop)

    def _stop(self) -> bool:
        self._finish("")
        return False

    def _finish(self, problem: str) -> None:
        self._found["problem"] = problem
        sys.stdout.write(json.dumps(self._found) + "\n")
        sys.stdout.flush()
        self._node.end("done")


if __name__ == "__main__":
    sys.exit(run("nav2_driver", Nav2Driver))
