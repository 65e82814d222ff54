"""Starts muxes, recorder or commanders inside a computer, on demand: starter FOLDER, with orders on standard input.

Orders and answers are lines of JSON. It is one of the programs of its computer: what kills or halts all of them kills
or halts it, too.
"""

import json
import os
import secrets
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import yaml
from bench.stop_network_parts.commander import MODULES, Commander, make_commander
from bench.stop_network_parts.lane import PATTERNS, Lane
from bench.stop_parts.nursery import Child, Nursery

MUX, RECORDER = "ur_nodes.motion.cmd_vel_mux_node", "bench.stop_network_parts.recorder"
_LIBRARY = Path(__file__).resolve().parents[2] / "ubiquity_launches"


class Starter:
    """Owns what it started. Each method is an order; what it returns is the answer."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._nursery = Nursery((*MODULES, MUX, RECORDER), folder)
        self._commanders: dict[str, Commander] = {}
        self._children: dict[str, Child] = {}
        self._master: subprocess.Popen[bytes] | None = None

    def master(self) -> int:
        """Start a ROS master on the usual port."""
        log = (self._folder / "master.log").open("ab")
        self._master = subprocess.Popen(
            ["/usr/bin/rosmaster", "--core", "-p", "11311"], stdin=subprocess.DEVNULL, stdout=log, stderr=log
        )
        return self._master.pid

    def mux(self, lane: dict[str, Any], base: str) -> int:
        """Start the mux of a lane."""
        found = Lane(**lane)
        sources = yaml.safe_load((_LIBRARY / "n_cmd_vel_mux" / "params" / "sources.yaml").read_text(encoding="utf-8"))
        parameters = [f"_{key}:={json.dumps(value)}" for key, value in sources.items()]
        name = f"mux {found.name}"
        self._children[name] = self._nursery.bear(
            MUX,
            *("__name:=cmd_vel_mux", "cmd_vel_out:=cmd_vel", f"_base:={base}", *parameters),
            namespace=found.prefix,
            name=found.name,
        )
        return self._children[name].pid

    def navigation(self, base: str) -> bool:
        """Start a whole simulated robot with navigation in `maze`, with the files that people start."""
        log = (self._folder / "navigation.log").open("ab")
        world = f"map_file:={_LIBRARY}/n_map_server/maps/maze.yaml"
        for name, more in (("m_robot_base", "world:=maze"), ("m_move_base", world)):
            path = _LIBRARY / name / "launch" / f"{name}.launch.xml"
            command = [sys.executable, "-I", "-m", "ur", "launch", str(path), f"robot_base:={base}", more]
            subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        return True

    def recorder(self, lanes: list[dict[str, Any]]) -> int:
        """Start what notes the motion and the leases of all lanes."""
        names = [f"{lane.name}={lane.prefix}" for lane in (Lane(**fields) for fields in lanes)]
        self._children["recorder"] = self._nursery.bear(RECORDER, str(self._folder), *names)
        return self._children["recorder"].pid

    def commander(self, lane: dict[str, Any], name: str = "", more: dict[str, str] | None = None) -> str:
        """Start the commander of a lane, in place of an earlier one; its client id. An empty `name` is the lane's.

        It takes the lease over, also from one that was killed a moment ago, unless `more` has another UR_LEASE.
        """
        found, client = Lane(**lane), secrets.token_hex(8)
        name = name or found.name
        if name in self._commanders:
            self._commanders.pop(name).close()
        environment = {"UR_CLIENT": client, "UR_LEASE": "take", **(more or {})}
        self._commanders[name] = make_commander(self._nursery, found, self._folder, environment)
        return client

    def drive(self, pattern: str, name: str = "") -> bool:
        """Have all persons, or one, keep to a pattern from now on; "" lets go."""
        for each, commander in self._commanders.items():
            if name in ("", each):
                commander.drive(PATTERNS.get(pattern))
        return True

    def press(self, name: str, key: str) -> bool:
        """Have a person press a key once."""
        self._commanders[name].press(key)
        return True

    def screen(self, name: str) -> list[str]:
        """The lines that a person sees."""
        return self._commanders[name].screen

    def signal(self, name: str, number: int) -> bool:
        """Send a signal to the programs of a commander."""
        self._commanders[name].signal(number)
        return True

    def kill(self, name: str) -> bool:
        """SIGKILL to the commander of a lane, a mux (`mux LANE`), the recorder or the master."""
        if name == "master" and self._master:
            self._master.kill()
            self._master.wait()
        elif name in self._commanders:
            self._commanders[name].signal(signal.SIGKILL)
        elif name in self._children:
            self._children[name].signal(signal.SIGKILL)
        return True


def main() -> int:
    """Carry out orders until the end of input. Returns the exit code."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    starter = Starter(folder)
    answers.write('"ready"\n')
    answers.flush()
    for line in sys.stdin:
        order: dict[str, Any] = json.loads(line)
        answer = getattr(starter, order.pop("do"))(**order)
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
