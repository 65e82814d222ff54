"""Run one program on one simulated base, look at what it shows, and stop it: what is wrong comes back as lines."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import psutil
from tests.e2e.conftest import ROOT, make_environment
from tests.e2e.matrix_ros2 import Ros2Ears, ros2_environment
from tests.e2e.matrix_table import Cell
from tests.e2e.matrix_topics import Ears, find_fault, find_tree_faults
from tests.office_fiducials import write_office_map

from ur.request.bases.base_argument import describe_base, describe_need
from ur.request.bases.robot_facts import read_facts
from ur.run.master.client import parse_master_uri
from ur.run.middleware.facts import read_facts as read_file
from ur.system.ros import read_domain

PATIENCE = 90.0  # s that a run gets to come up, and its topics to come at their rates
LOOK = 0.1  # s between two looks
END = 60.0  # s that each node gets to end after an interrupt: a busy computer is slow, and only what hangs is a fault
_CLEAN = (0, 130)  # exit codes of a run that was interrupted: of its own, or of the node that has the terminal


@dataclass(slots=True)
class Result:
    """How a cell went: `faults` is empty when all is well."""

    faults: list[str] = field(default_factory=list)


def try_cell(
    cell: Cell,
    folder: Path,
    environment: Mapping[str, str] | None = None,
    domain: str | None = None,
) -> Result:
    """Run a cell in an empty folder of its own, from its start to its end, with more `environment` than it needs.

    With a `domain`, on ROS 2 and in that domain.
    """
    env = _environment(folder) | dict(environment or {})
    if domain is not None:
        env = _select_ros2(env, folder, domain)
    return _try_refusal(cell, folder, env) if cell.lacks else _try_run(cell, folder, env)


def _words(cell: Cell, folder: Path) -> list[str]:
    variant = [f"robot_variant:={cell.base.variant}"] if cell.base.variant else []
    more = [word.replace("{folder}", str(folder)) for word in cell.arguments]
    if any("{fiducial_map}" in word for word in more):
        map_ = write_office_map(folder / "fiducials.txt")
        more = [word.replace("{fiducial_map}", str(map_)) for word in more]
    return [str(cell.program.path), f"robot_base:={cell.base.name}", *variant, *more]


def _environment(folder: Path) -> dict[str, str]:
    return make_environment(folder) | {"XDG_STATE_HOME": str(folder / "state"), "XDG_RUNTIME_DIR": str(folder / "run")}


def _select_ros2(env: dict[str, str], folder: Path, domain: str) -> dict[str, str]:
    """As `ur use sim --ros 2` does: programs find the rest by themselves, the node that hears topics needs it all."""
    ours = {name: value for name, value in env.items() if not name.startswith("ROS_")}
    subprocess.run([str(ROOT / "ur"), "use", "sim", "--ros", "2"], env=ours, capture_output=True, check=True)
    return ours | ros2_environment(folder, domain)


def _try_refusal(cell: Cell, folder: Path, env: dict[str, str]) -> Result:
    """What a base cannot do is said in one line and one that helps; nothing is started."""
    done = subprocess.run(
        _words(cell, folder),
        env=env,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    result = Result()
    lines = done.stderr.splitlines()
    wanted = " and ".join(describe_need(need) for need in cell.lacks)
    if done.returncode not in (1, 2):
        result.faults.append(f"exit code {done.returncode}, expected 1 or 2: {describe_base(cell.base)} lacks {wanted}")
    if len(lines) != 2 or f" needs {wanted}, and base " not in lines[0] or not lines[1].startswith("  help: "):
        result.faults.append(f"standard error: {done.stderr!r}, expected one line that says what is needed, and help")
    if done.stdout:
        result.faults.append(f"standard output: {done.stdout!r}, expected nothing")
    return result


def _try_run(cell: Cell, folder: Path, env: dict[str, str]) -> Result:
    result = Result()
    with _start(cell, folder, env) as run:
        deadline = time.monotonic() + PATIENCE
        if run.wait_ready(deadline):
            _look(cell, run.master_uri, env, result, deadline)
        else:
            result.faults.append(f"not up after {PATIENCE:g} s: {run.describe_missing()}")
        _stop(run, result)
    said = [line for line in run.said if not any(each in line for each in cell.may_say)]
    result.faults += [f"said: {line}" for line in said]
    left = [process.pid for process in psutil.process_iter(["environ"]) if _is_of(process, env["XDG_RUNTIME_DIR"])]
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    if left:
        result.faults.append(f"{len(left)} processes are still there after the end")
    if list((folder / "state").glob("ur/runs/*")):
        result.faults.append("the run is still registered after its end")
    return result


def _is_of(process: psutil.Process, folder: str) -> bool:
    return (process.info["environ"] or {}).get("XDG_RUNTIME_DIR") == folder


def _listen(cell: Cell, address: str, env: Mapping[str, str]) -> Ears | Ros2Ears:
    if read_domain(address) is not None:
        return Ros2Ears(env, cell.topics)
    return Ears(parse_master_uri(address), cell.topics)


def _look(cell: Cell, master_uri: str, env: Mapping[str, str], result: Result, deadline: float) -> None:
    ears = _listen(cell, master_uri, env)
    right: set[str] = set()  # what came at its rate once does: this computer may have other things to do meanwhile
    try:
        while True:
            ears.connect()
            ears.listen(LOOK)
            found = {topic.name: find_fault(topic, ears.heard[topic.name]) for topic in cell.topics}
            right |= {name for name, fault in found.items() if not fault}
            faults = [fault for name, fault in found.items() if name not in right]
            faults += find_tree_faults(ears.frames, cell.root, cell.frames)
            if not faults or time.monotonic() > deadline:
                break
    finally:
        ears.close()
    result.faults += faults
    if (facts := _read_facts(master_uri, env)) != (cell.base.name, cell.base.variant):
        result.faults.append(f"the run says that the robot is {facts}, expected {describe_base(cell.base)}")


def _read_facts(address: str, env: Mapping[str, str]) -> tuple[object, object] | None:
    if read_domain(address) is None:
        return read_facts(address)
    found = read_file(env["UR_FACTS"])
    return found.get("base_name"), found.get("variant")


def _stop(run: ProgramRun, result: Result) -> None:
    run.process.send_signal(signal.SIGINT)
    if not run.drain(time.monotonic() + 2.0 * END):
        result.faults.append(f"does not end within {2.0 * END:g} s of an interrupt")
        run.process.kill()
    code = run.process.wait()
    if code not in _CLEAN:
        result.faults.append(f"exit code {code} after an interrupt, expected 0 or 130")
    for name, event in run.nodes.items():
        if event["state"] != "ended" or event["restarts"]:
            result.faults.append(f"{name}: {event['state']}, {event['restarts']} restarts: {event['reason']}")
        if event["exit_code"] not in (0, 130, None) or event["signal"] not in (signal.SIGINT, None):
            result.faults.append(f"{name}: exit code {event['exit_code']}, signal {event['signal']} at the end")


class ProgramRun:
    """A program under `--json`: `nodes` is how each stands, `said` what any of them wrote to standard error."""

    def __init__(self, process: subprocess.Popen[bytes], errors: Path) -> None:
        self.process = process
        self.nodes: dict[str, dict[str, Any]] = {}
        self.master_uri = ""
        self._errors = errors
        self._lines: list[str] = []
        self._missing: dict[str, list[str]] = {}
        self._rest = b""

    @property
    def said(self) -> list[str]:
        """Warnings, errors and whatever else came on standard error; not what a run says about itself."""
        own = self._errors.read_text(encoding="utf-8", errors="replace").splitlines()
        return [*(line for line in own if not _is_greeting(line)), *self._lines]

    def wait_ready(self, deadline: float) -> bool:
        """Whether every node is up in time."""
        while self._read(deadline):
            if self.nodes and all(name in self._missing and not self._missing[name] for name in self.nodes):
                return True
        return False

    def drain(self, deadline: float) -> bool:
        """Take in what happens until the end; False when that does not come in time."""
        while self._read(deadline):
            pass
        return time.monotonic() < deadline

    def describe_missing(self) -> str:
        """Which nodes are not up, and why."""
        lacking = {name: self._missing.get(name, ["never started"]) for name in self.nodes}
        words = [f"{name}: {', '.join(lack)}" for name, lack in lacking.items() if lack]
        return "; ".join(words) or f"it has ended: {self._errors.read_text(errors='replace')[-2000:]}"

    def _read(self, deadline: float) -> bool:
        stream: IO[bytes] | None = self.process.stdout
        assert stream
        if not select.select([stream], [], [], max(0.0, deadline - time.monotonic()))[0]:
            return False
        data = os.read(stream.fileno(), 1 << 16)
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            if line.startswith(b"{"):  # what the node that has the terminal prints comes in between
                self._take(json.loads(line))
        return bool(data)

    def _take(self, event: dict[str, Any]) -> None:
        match event["kind"]:
            case "RunStarted":
                self.master_uri = event["master_uri"]
            case "NodeChanged" if not event["core"]:
                self.nodes[event["name"]] = event
            case "NodeReadiness":
                self._missing[event["name"]] = event["missing"]
            case "OutputLine" if _complains(event):
                self._lines.append(f"[{event['name']}] {event['text']}")
            case "Notice" if event["severity"] in ("warning", "error", "fatal"):
                self._lines.append(event["text"])


def _complains(line: Mapping[str, Any]) -> bool:
    """Whether a line is a warning, or on standard error: where ROS 2 writes its information, too."""
    informs = line["text"].startswith(("[INFO]", "[DEBUG]"))
    return line["severity"] in ("warning", "error", "fatal") or (line["stream"] == "err" and not informs)


def _is_greeting(line: str) -> bool:
    return line.startswith(("ROS_MASTER_URI=", "ROS 2 ", "stopping: ")) or " log files in " in line


@contextmanager
def _start(cell: Cell, folder: Path, env: dict[str, str]) -> Iterator[ProgramRun]:
    errors = folder / "errors.txt"
    words = [*_words(cell, folder), "--json", "--sigint-timeout", f"{END:g}"]
    pipe = subprocess.PIPE
    with errors.open("wb") as sink:
        process = subprocess.Popen(words, env=env, stdin=pipe, stdout=pipe, stderr=sink, cwd=folder)
    try:
        yield ProgramRun(process, errors)
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        for stream in (process.stdin, process.stdout):
            assert stream
            stream.close()
