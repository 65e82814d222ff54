"""Random lives of a robot on ROS 2: start, goal, a fault, end. Prints a line for each; exits with 1 if one was wrong.

    python -m tests.ur_nodes.ros2.lives [--lives 100] [--seed 0]

A life is wrong when the base does not come to rest after what has to stop it, when a node does not end by itself, ends
with another code than 0, or prints a traceback, and when a process is left.
"""

from __future__ import annotations

import argparse
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread

from tests.ros2_session import PYTHON, Ros2Session
from tests.ur_nodes.first_drive.drive import read_launch_files
from tests.ur_nodes.ros2.test_goal_on_ros2 import MODULES, write_parameters

CLIENT = str(Path(__file__).with_name("life_client.py"))
GOALS = ("0.8 0.4 1.57", "1.5 0.5 0.0", "2.0 1.0 1.57")
STOPPING = ("cancel", "stop", "kill move_base", "kill cmd_vel_mux")
"""Faults after which the base has to be at rest."""
FAULTS = (*STOPPING, "kill amcl", "kill map_server", "kill client", "cut client", "second client", "none")
_READY = 150.0  # s: a node takes 3 s of processor to start
_REST = 3.0  # s in which the base has to be at rest, and what the client prints has arrived
_END = 10.0  # s
_AT_REST = 0.02


@dataclass(slots=True)
class StartedClient:
    """A program that drives or watches, and what it printed last."""

    program: subprocess.Popen[str]
    speed: float | None = None
    goal: str = "no goal"
    seen: set[str] = field(default_factory=set)

    def follow(self) -> None:
        assert self.program.stdout is not None
        for line in self.program.stdout:
            if line.startswith("{"):
                read = json.loads(line)
                self.speed, self.goal = read["speed"], read["goal"]
                self.seen.add(self.goal)

    def tell(self, line: str) -> None:
        assert self.program.stdin is not None
        self.program.stdin.write(f"{line}\n")
        self.program.stdin.flush()


class Life:
    """One life. `wrong` says what was."""

    def __init__(self, seed: int, folder: Path) -> None:
        self._random = random.Random(seed)
        self.fault = FAULTS[seed % len(FAULTS)]
        self.wrong: list[str] = []
        self.drove = False
        self.started = 0.0  # s from the start of the nodes to motion
        self._folder = folder
        self._session = Ros2Session(folder)
        self._nodes: dict[str, subprocess.Popen[str]] = {}
        self._clients: list[StartedClient] = []

    def live(self) -> None:
        """Live it, and end all processes."""
        try:
            self._start()
            self._suffer()
            self._end()
        finally:
            for each in (*self._nodes.values(), *(client.program for client in self._clients)):
                if each.poll() is None:
                    self.wrong.append(f"process {each.args!r} was left")
                    each.kill()
                    each.wait()
        for log in sorted(self._folder.glob("*.txt")):
            if "Traceback" in log.read_text():
                self.wrong.append(f"traceback of {log.stem}")

    def _start(self) -> None:
        plan = read_launch_files("maze")
        self._session.environment |= {name: value for node in plan.nodes for name, value in node.env}
        nodes = [node for node in plan.nodes if node.full_name in MODULES]
        self._random.shuffle(nodes)
        for node in nodes:
            file = self._folder / f"{node.name}.yaml"
            write_parameters(plan, node.full_name, file)
            remaps = [f"{source}:={target}" for source, target in node.remaps]
            options = ("--ros-args", "--params-file", str(file))
            self._nodes[node.name] = self._session.start(node.name, MODULES[node.full_name], *remaps, *options)
        self._watcher = self._join("watcher", "watch")
        self._driver = self._join("driver", "drive", *self._random.choice(GOALS).split())
        begin = time.monotonic()
        if not self._wait(lambda: self._moves() or self._driver.goal in ("reached", "failed"), _READY):
            self.wrong.append(f"the robot did not start to drive; {self._describe()}")
        self.started = time.monotonic() - begin
        self.drove = self._moves()

    def _suffer(self) -> None:
        self._wait(lambda: not self._moves(), self._random.uniform(0.0, 2.0))
        what, _, name = self.fault.partition(" ")
        if what in ("cancel", "stop"):
            self._watcher.tell(what)
        elif what == "kill" and name == "client":
            self._driver.program.kill()
            self._driver.program.wait()
        elif what == "kill":
            self._nodes[name].kill()
            self._nodes[name].wait()
        elif what == "cut":
            self._driver.program.send_signal(signal.SIGSTOP)
            self._wait(lambda: False, 1.0)
            self._driver.program.send_signal(signal.SIGCONT)
        elif what == "second":
            self._join("other", "drive", *self._random.choice(GOALS).split())
            self._wait(lambda: self._clients[-1].goal in ("driving", "reached"), _END)
        if self.fault in STOPPING and not self._wait(lambda: not self._moves(), _REST):
            self.wrong.append(f"{self._watcher.speed:.2f} m/s or rad/s {_REST:g} s after '{self.fault}'")

    def _end(self) -> None:
        killed = {name for name, node in self._nodes.items() if node.poll() is not None}
        names = [name for name in self._nodes if name != "simulator"]
        self._random.shuffle(names)
        for name in names:
            self._nodes[name].send_signal(self._random.choice((signal.SIGINT, signal.SIGTERM)))
        for name in names:
            self._wait_for(name, self._nodes[name], None if name in killed else 0)
        if not self._wait(lambda: not self._moves(), _REST):
            self.wrong.append(f"{self._watcher.speed:.2f} m/s or rad/s {_REST:g} s after the end")
        for client in self._clients:
            alive = client.program.poll() is None
            client.program.send_signal(signal.SIGINT)
            self._wait_for("client", client.program, 0 if alive else None)
        self._nodes["simulator"].send_signal(signal.SIGINT)
        self._wait_for("simulator", self._nodes["simulator"], 0)

    def _join(self, name: str, *arguments: str) -> StartedClient:
        command = [str(PYTHON), "-m", "ur_nodes", CLIENT, *arguments, f"__name:={name}"]
        with (self._folder / f"{name}.txt").open("w") as errors:
            program = subprocess.Popen(
                command,
                env=self._session.environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
            )
        client = StartedClient(program)
        Thread(target=client.follow, daemon=True).start()
        self._clients.append(client)
        return client

    def _describe(self) -> str:
        """Describe what the clients have received."""
        speed = "no odometry" if self._watcher.speed is None else f"{self._watcher.speed:.2f} m/s or rad/s"
        return f"the watcher has {speed}, the driver the goal '{self._driver.goal}'"

    def _moves(self) -> bool:
        return self._watcher.speed is not None and self._watcher.speed > _AT_REST

    @staticmethod
    def _wait(condition: Callable[[], bool], within: float) -> bool:
        end = time.monotonic() + within
        while not condition():
            if time.monotonic() > end:
                return False
            time.sleep(0.02)
        return True

    def _wait_for(self, name: str, program: subprocess.Popen[str], code: int | None) -> None:
        try:
            ended = program.wait(_END)
        except subprocess.TimeoutExpired:
            self.wrong.append(f"{name} did not end within {_END:g} s")
        else:
            if code is not None and ended != code:
                self.wrong.append(f"{name} ended with {ended}")


def live_all(count: int, seed: int, output: Callable[[str], object]) -> int:
    """Live so many lives; return how many were wrong."""
    wrong, drove, faults = 0, 0, Counter[str]()
    for number in range(seed, seed + count):
        with tempfile.TemporaryDirectory() as folder:
            life = Life(number, Path(folder))
            life.live()
            wrong, drove = wrong + bool(life.wrong), drove + life.drove
            faults[life.fault] += 1
            output(
                f"life {number}, {life.fault}, drives after {life.started:.1f} s: {'; '.join(life.wrong) or 'good'}\n"
            )
            if life.wrong:
                for log in sorted(Path(folder).glob("*.txt")):
                    output("".join(f"  {log.stem}: {line}\n" for line in log.read_text().splitlines()[-12:]))
    output(f"{count} lives, {drove} moved when the fault came, {wrong} wrong\n")
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lives", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()

    def output(text: str) -> None:
        sys.stdout.write(text)
        sys.stdout.flush()

    return int(live_all(options.lives, options.seed, output) > 0)


if __name__ == "__main__":
    sys.exit(main())
