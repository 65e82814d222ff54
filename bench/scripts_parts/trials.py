"""Trials: a script drives from another computer and is lost; what the robot does, and what every screen shows."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from tests.cut_network import ADDRESSES
from tests.e2e.terminal import ProgramTerminal
from tests.e2e.web_page import PROGRAM, open_first, start_server

ROOT = Path(__file__).resolve().parents[2]
NODE = str(ROOT / "ubiquity_launches" / "lib" / "node")
PARTS = Path(__file__).parent
CAUSES = ("hangs", "raises", "killed", "network")
MODES = ("drive", "goal")
LIMITS = {"drive": 0.3, "goal": 3.0}  # s
_AT_REST = (0.01, 0.02)  # m/s, rad/s
_RESTS = 1.0  # s for which it has to be at rest
_PATIENCE = 90.0  # s
_LINES = {"raises": r"victim ended with RuntimeError"}
_LINE = r"\(victim\) drove until \d\d:\d\d( [AP]M)? and is out of reach"


@dataclass(slots=True)
class Witness:
    """What the node beside the robot has printed."""

    process: subprocess.Popen[str]
    velocities: list[tuple[float, float, float]] = field(default_factory=list)
    hold: str = ""

    def read(self) -> None:
        """Take lines until the node ends."""
        assert self.process.stdout
        for line in self.process.stdout:
            values = json.loads(line)
            if len(values) == 3:
                self.velocities.append(tuple(values))
            else:
                self.hold = values[1]

    def is_fast(self) -> bool:
        """Return whether the robot moves."""
        return bool(self.velocities) and abs(self.velocities[-1][1]) > 0.1

    def rests_since(self) -> float | None:
        """Return since when (monotonic s) the robot is at rest for good; None: it is not."""
        seen = list(self.velocities)
        moved = [at for at, ahead, turn in seen if abs(ahead) > _AT_REST[0] or abs(turn) > _AT_REST[1]]
        since = moved[-1] if moved else 0.0
        return since if seen and seen[-1][0] - since > _RESTS else None


@dataclass(slots=True)
class Laptop:
    """The computer of the script, and the cable between the two."""

    pids: Mapping[str, str]
    environment: Mapping[str, str]
    more: Mapping[str, str]

    def start(self, *words: str) -> subprocess.Popen[str]:
        """Start a script there."""
        command = ["nsenter", f"--net=/proc/{self.pids['laptop']}/ns/net", "--", NODE, *words]
        environment = {**self.environment, **self.more}
        return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def connect(self, *, cut: bool) -> None:
        """Cut the network, or restore it."""
        link = ["nomaster"] if cut else ["master", "switch"]
        wrapped = ["nsenter", f"--net=/proc/{self.pids['switch']}/ns/net", "--", "ip", "link", "set", "robot", *link]
        subprocess.run(wrapped, check=True)


def addresses(version: str, side: str, port: str) -> dict[str, str]:
    """The variables by which programs of a side find the other one."""
    if version == "2":
        return {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    return {"ROS_MASTER_URI": f"http://{ADDRESSES['robot']}:{port}", "ROS_HOSTNAME": ADDRESSES[side]}


def lose(laptop: Laptop, script: subprocess.Popen[str], cause: str) -> float:
    """Let a script be lost; return when (monotonic s)."""
    at = time.monotonic()
    if cause == "network":
        laptop.connect(cut=True)
    else:
        script.send_signal({"hangs": signal.SIGUSR1, "raises": signal.SIGUSR2, "killed": signal.SIGKILL}[cause])
    return at


def run_trial(
    laptop: Laptop,
    witness: Witness,
    screens: Mapping[str, Callable[[], str]],
    forget: Callable[[], None],
    mode: str,
    cause: str,
) -> dict[str, object]:
    """One trial: seconds until the robot is at rest for good, until which screen shows the line, and the goal's state.

    `forget` lets the screens begin anew.
    """
    home = laptop.start(str(PARTS / "victim.py"), "home")
    if home.wait(_PATIENCE):
        return {"problem": f"did not come home: {home.communicate()[1][-300:]}"}
    script = laptop.start(str(PARTS / "victim.py"), mode)
    try:
        if not wait(witness.is_fast, script):
            script.kill()
            return {"problem": f"did not drive: {script.communicate()[1][-300:]}"}
        time.sleep(0.5)
        if script.poll() is not None:
            return {"problem": f"ended by itself: {script.communicate()[1][-300:]}"}
        forget()
        at = lose(laptop, script, cause)
        line = re.compile(_LINES.get(cause, _LINE))
        shown: dict[str, float] = {}

        def is_shown() -> bool:
            for name, read in screens.items():
                if name not in shown and line.search(re.sub(r"\s+", " ", read())):
                    shown[name] = time.monotonic() - at
            return len(shown) == len(screens) and witness.rests_since() is not None

        wait(is_shown, None, 15.0)
        since = witness.rests_since()
        return {"rest": max(0.0, since - at) if since is not None else None, "shown": shown, "hold": witness.hold}
    finally:
        if script.poll() is None:
            script.kill()
        script.communicate()
        if cause == "network":
            laptop.connect(cut=False)


def wait(condition: Callable[[], bool], script: subprocess.Popen[str] | None, seconds: float = _PATIENCE) -> bool:
    """Wait until something is true, while a script runs."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end or (script is not None and script.poll() is not None):
            return condition()
        time.sleep(0.02)
    return True


def run_all(
    version: str, environment: Mapping[str, str], folder: Path, pids: Mapping[str, str], trials: int
) -> list[dict[str, object]]:
    """All causes and modes by turns, beside a robot that navigates; from within the robot's network."""
    port = environment.get("ROS_MASTER_URI", ":").rpartition(":")[2]
    here = {**environment, **addresses(version, "robot", port)}
    laptop = Laptop(pids, environment, addresses(version, "laptop", port))
    results = []
    command = [str(ROOT / "ur"), "run", "keyboard_navigate", "--watch"]
    with ProgramTerminal(command, here, columns=120, rows=40) as terminal, start_server(here, folder) as server:
        subprocess.run(
            [str(ROOT / "ur"), "wait", "--timeout-ready", "120"],
            env=here,
            check=False,
            capture_output=True,
            timeout=300,
        )
        node = subprocess.Popen([NODE, str(PARTS / "witness.py")], env=here, stdout=subprocess.PIPE, text=True)
        witness = Witness(node)
        threading.Thread(target=witness.read, daemon=True).start()
        assert PROGRAM is not None, "no Chromium"
        with open_first(server, folder) as browser:

            def read_page() -> str:
                return str(browser.run("document.querySelector('#banners')?.innerText ?? ''"))

            screens: dict[str, Callable[[], str]] = {"terminal": lambda: terminal.text[-6000:], "page": read_page}
            try:
                for turn in range(trials):
                    for mode in MODES:
                        for cause in CAUSES:
                            found = run_trial(laptop, witness, screens, terminal.forget, mode, cause)
                            results.append({"turn": turn, "mode": mode, "cause": cause, **found})
                            print(json.dumps(results[-1]), flush=True)
            finally:
                node.kill()
                node.wait()
    return results
