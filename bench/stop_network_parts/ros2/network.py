"""A robot of ROS 2 with a mux and motors for each lane, commanders on a laptop, and one trial of all lanes at once."""

from __future__ import annotations

import os
import random
import re
import shutil
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from bench.stop_network_parts.lane import Lane
from bench.stop_network_parts.network import LIBRARY, Trial
from bench.stop_network_parts.recorder import read_outputs
from bench.stop_network_parts.ros2.computers import ADDRESSES, Computers, Program, start_computers, wait_for
from bench.stop_network_parts.verdict import is_at_rest, judge, simulate_base
from bench.stop_parts.nursery import read_sent

from ur.robot.base import BRAKE_AFTER, load_base

MOTORS = {"client": "twist", "plain": "stamped", "stamped": "twist", "vendor": "twist"}
"""The lanes, each with what its base takes: Twist or TwistStamped."""
LANES = tuple(Lane(name, "linear", 0.5, name) for name in MOTORS)
_BASE = "base.yaml"
_ROOT = Path(__file__).resolve().parents[3]
PYTHON = _ROOT / ".ros2/bin/python"
"""Python with the wheels of ROS 2."""
_PARTS = "bench.stop_network_parts.ros2"
_MUX = "ur_nodes.motion.cmd_vel_mux_node"
_SOURCE = ("_topics/keyboard/topic:=key_vel", "_topics/keyboard/timeout:=0.15", "_topics/keyboard/priority:=90")
_LOOK = 0.05  # s: how often it is noted how long processes have waited
_WINDOW = 0.5  # s
_AFTER = 1.5  # s: what is looked at after nothing can arrive any more
_REST = 1.0  # s: how long nothing may have driven a base before a trial begins
_PATIENCE = 90.0  # s: for all lanes to drive, and to be at rest
_VENDOR = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="wlan0"/></Interfaces>
<AllowMulticast>{multicast}</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="{robot}"/></Peers></Discovery>
<Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation></Compatibility></Domain></CycloneDDS>"""


class Network:
    """The computers and what runs on them."""

    def __init__(self, computers: Computers, base: str, seed: int, speed: float, *, multicast: bool) -> None:
        self.computers, self.multicast = computers, multicast
        self.chance = random.Random(seed)
        self.package = write_base(computers.folder, base, speed) if speed else LIBRARY
        self.base = load_base(self.package, base, "")
        limits = self.base.limits
        rest = BRAKE_AFTER + limits.velocity / limits.deceleration if limits.fast else LANES[0].rest
        self.lanes = tuple(
            replace(lane, speed=speed or lane.speed, rest=1.05 * rest) if speed else lane for lane in LANES
        )
        self.commanders: dict[str, Program] = {}
        self.second: dict[str, Program] = {}
        self.muxes: dict[str, Program] = {}
        self._motors: dict[str, Program] = {}
        self._ended = threading.Event()
        self._looker = threading.Thread(target=self._look, daemon=True)
        computers.order(multicast=multicast)

    def start(self) -> None:
        """Start everything."""
        for lane in LANES:
            more = self._on_robot(lane)
            command = [str(PYTHON), "-m", f"{_PARTS}.motors", MOTORS[lane.name], lane.name, str(self._notes(lane))]
            self._motors[lane.name] = self.computers.start("robot", f"motors_{lane.name}", command, more)
        self.start_muxes()
        self.start_commanders()
        self._looker.start()

    def start_muxes(self) -> None:
        """Start the muxes, in place of earlier ones."""
        self._end(self.muxes)
        for lane in LANES:
            names = ("__name:=cmd_vel_mux", f"__ns:={lane.name}", "cmd_vel_out:=base_vel", "_takes_over:=cmd_vel")
            command = [
                str(PYTHON),
                "-m",
                "ur_nodes",
                _MUX,
                *names,
                f"_base:={self.base.name}",
                f"_package:={self.package}",
                *_SOURCE,
            ]
            mux = self.computers.start("robot", f"mux_{lane.name}", command, self._on_robot(lane))
            self.muxes[lane.name] = mux
        pids = {f"mux {name}": mux.process.pid for name, mux in self.muxes.items()}
        pids |= {f"motors {name}": motors.process.pid for name, motors in self._motors.items()}
        self.computers.waits.follow(pids)

    def start_commanders(self) -> None:
        """Start the laptop's commanders, in place of earlier ones."""
        self._end(self.commanders)
        self.commanders = {lane.name: self._command("laptop", lane, lane.name) for lane in LANES}

    def start_second(self, more: dict[str, str]) -> None:
        """Start the commanders of a second laptop."""
        self.second = {
            lane.name: self._command("laptop2", lane, "client-takes" if lane.name == "client" else lane.name, more)
            for lane in LANES
        }

    def end_second(self) -> None:
        """End the commanders of the second laptop."""
        self._end(self.second)

    def close(self) -> None:
        """End the threads."""
        self._ended.set()
        if self._looker.is_alive():
            self._looker.join()

    def drive(self, pattern: str, commanders: dict[str, Program] | None = None) -> None:
        """Have commanders follow a pattern; '' lets go."""
        for each in (self.commanders if commanders is None else commanders).values():
            each.order(pattern)

    def run(self, cause: str, pattern: str, happen: Callable[[Network], None]) -> list[Trial]:
        """One trial of all lanes. Raises RuntimeError: the lanes are not at rest before, or do not drive."""
        wait_for(lambda: all(map(self._rests, LANES)), _PATIENCE, "bases at rest")
        began = time.monotonic()
        self.drive(pattern)
        try:
            wait_for(lambda: all(self._drives(lane, began) for lane in LANES), _PATIENCE, "bases that drive")
        except RuntimeError as problem:
            idle = ", ".join(lane.name for lane in LANES if not self._drives(lane, began))
            raise RuntimeError(f"{cause}, {pattern}: {problem}, not {idle}") from None
        time.sleep(self.chance.uniform(0.3, 1.2))
        since = time.monotonic()
        happen(self)
        time.sleep(_AFTER)
        end = time.monotonic()
        self.drive("")
        return [self._judge(cause, pattern, lane, began, since, end) for lane in self.lanes]

    def _judge(self, cause: str, pattern: str, lane: Lane, began: float, since: float, end: float) -> Trial:
        files = (self._sent(lane, side) for side in ("laptop", "laptop2"))
        sent = [(each.monotonic, each.forward, each.turn) for file in files for each in read_sent(file)]
        arrives = self.computers.can_arrive
        commands = [each for each in sorted(sent) if began - 1.0 <= each[0] <= end and arrives(each[0])]
        outputs = [each for each in read_outputs(self._notes(lane)) if began - 1.0 <= each.at <= end]
        verdict = judge(lane, commands, simulate_base(self.base, outputs, end), since)
        ghosts = tuple(self._waited(lane, ghost.began) for ghost in verdict.ghosts)
        return Trial(cause, lane, pattern, verdict, self._waited(lane, verdict.at), len(commands), None, ghosts)

    def _waited(self, lane: Lane, at: float) -> float:
        waits = self.computers.waits
        return sum(waits.between(f"{part} {lane.name}", at - _WINDOW, at) for part in ("mux", "motors"))

    def _rests(self, lane: Lane) -> bool:
        return is_at_rest(read_outputs(self._notes(lane)), time.monotonic() - _REST)

    def _drives(self, lane: Lane, since: float) -> bool:
        return any(each.forward for each in read_outputs(self._notes(lane)) if each.at >= since)

    def _command(self, side: str, lane: Lane, kind: str, more: dict[str, str] | None = None) -> Program:
        module = [f"{_PARTS}.vendor", lane.name] if kind == "vendor" else [f"{_PARTS}.commander", kind, lane.name]
        command = [str(PYTHON), "-m", *module, str(self._sent(lane, side))]
        clock = {"LD_PRELOAD": self.computers.environment["UR_BENCH_CLOCK"]} if side == "laptop" else {}
        return self.computers.start(side, f"{side}_{lane.name}", command, {**clock, **(more or {})})

    def _on_robot(self, lane: Lane) -> dict[str, str]:
        folder = self.computers.folder / lane.name
        folder.mkdir(exist_ok=True)
        return {"UR_FACTS": str(folder / "facts.json"), "HOME": str(folder), "ROS_HOME": str(folder)}

    def _notes(self, lane: Lane) -> Path:
        return self.computers.folder / f"{lane.name}.motors"

    def _sent(self, lane: Lane, side: str) -> Path:
        return self.computers.folder / f"{lane.name}.{side}"

    def _end(self, programs: dict[str, Program]) -> None:
        for program in programs.values():
            self.computers.end(program)
        programs.clear()

    def _look(self) -> None:
        while not self._ended.wait(_LOOK):
            self.computers.waits.look()


@contextmanager
def start_network(folder: Path, base: str, seed: int, speed: float = 0.0, *, multicast: bool) -> Iterator[Network]:
    """Computers with everything started. `folder` takes notes and logs."""
    for left in folder.iterdir():
        shutil.rmtree(left) if left.is_dir() else left.unlink()
    peers = ";".join(ADDRESSES.values())
    environment = {
        **{name: value for name, value in os.environ.items() if not name.startswith(("ROS_", "UR_"))},
        "AMENT_PREFIX_PATH": str(_ROOT / ".ros2"),
        "PYTHONPATH": f"{_ROOT}{os.pathsep}{_ROOT / 'src'}",
        "ROS_VERSION": "2",
        "ROS_DOMAIN_ID": "0",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
        "ROS_STATIC_PEERS": peers,
        "ROS_LOG_DIR": str(folder),
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",  # the computers share a kernel, and so its memory
        "CYCLONEDDS_URI": _VENDOR.format(multicast=str(multicast).lower(), robot=ADDRESSES["robot"]),
        "UR_BENCH_CLOCK": str(_make_clock(folder)),
        "UR_BENCH_SPEED": str(speed or ""),
    }
    with start_computers(folder, environment) as computers:
        network = Network(computers, base, seed, speed, multicast=multicast)
        try:
            network.start()
            yield network
        finally:
            network.close()


def write_base(folder: Path, base: str, speed: float) -> Path:
    """Write a package with a base that is so fast (m/s) into a folder, and return the package."""
    text = (LIBRARY / "bases" / base / _BASE).read_text()
    place = folder / "package/bases" / base
    place.mkdir(parents=True)
    (place / _BASE).write_text(re.sub(r"\{velocity: [0-9.]+", f"{{velocity: {speed:g}", text))
    return folder / "package"


def set_clock(folder: Path, seconds: float) -> None:
    """Have the laptop's clock differ by so much."""
    with (folder / "clock").open("r+b") as file:
        file.write(round(seconds * 1e9).to_bytes(8, "little", signed=True))


def _make_clock(folder: Path) -> Path:
    """A library that makes the laptop's clock wrong, by what a file says."""
    text = (_ROOT / "tests/hosts/other_clock.c").read_text().replace("/run/other-clock", str(folder / "clock"))
    (folder / "clock").write_bytes(bytes(8))
    source, library = folder / "clock.c", folder / "clock.so"
    source.write_text(text)
    with suppress(FileNotFoundError):
        subprocess.run(["gcc", "-shared", "-fPIC", "-O1", "-o", library, source], check=True)
    return library
