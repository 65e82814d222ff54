"""The robot's end of a program whose other nodes run on a laptop: starts the robot's part, finds it again, ends it.

`python -m ur.run.part_side` reads a request as JSON from standard input and prints an answer as JSON. The part is a
detached run of its own: it outlives the connection that asked for it, and the laptop. It is found again by its command
line, so nothing has to be remembered that could be wrong.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

from ur.run.client import RunGone, connect_run, iterate_events
from ur.run.events import RunStopping, Synchronised
from ur.run.master import parse_master_uri
from ur.run.registry import RunEntry, list_runs, read_birth
from ur.run.xml_rpc import Refused, Unanswered

START_SECONDS = 60.0
END_SECONDS = 25.0
_MARK = "--part"


@dataclass(frozen=True, slots=True)
class Request:
    """`machine` is the robot's name in the launch file, `words` those after the options of `ur launch`, complete.

    `nodes` are the full names of the part's nodes, as far as they are the same each time.
    """

    action: Literal["begin", "end"]
    machine: str
    words: tuple[str, ...]
    options: tuple[str, ...] = ()
    nodes: tuple[str, ...] = ()
    master_uri: str = ""
    host: str = ""


@dataclass(frozen=True, slots=True)
class Answer:
    """`run` is the id of the part's run, '' without one; `found`: it ran before; `running`: nodes that others started.

    `problem` is what `ur launch` said when it could not start.
    """

    run: str = ""
    found: bool = False
    running: tuple[str, ...] = field(default=())
    problem: str = ""


def mark_words(request: Request) -> list[str]:
    """The end of a command line by which the part's run is known."""
    return [_MARK, request.machine, *request.options, "--", *request.words]


def is_marked(command: Sequence[str], request: Request) -> bool:
    """Whether a process with this command line is the run of a request."""
    mark = mark_words(request)
    return list(command[-len(mark) :]) == mark


def launch_words(request: Request, running: Sequence[str]) -> list[str]:
    """The words after `ur` that start the part, without nodes that run already."""
    left_out = [word for name in running for word in ("--runs-already", name)]
    return ["launch", "--plain", "--detach", *left_out, *mark_words(request)]


def parse_request(text: str) -> Request:
    """A request as it came. Raises ValueError and TypeError for what is none."""
    return Request(**_parse(text))


def parse_answer(text: str) -> Answer:
    """An answer as it came. Raises ValueError and TypeError for what is none."""
    return Answer(**_parse(text))


def _parse(text: str) -> dict[str, Any]:
    loaded = json.loads(text)
    if not isinstance(loaded, dict):
        raise TypeError(text)
    return {key: tuple(value) if isinstance(value, list) else value for key, value in loaded.items()}


def begin(request: Request) -> Answer:
    """Find the part's run, or start it."""
    entry = _find(request)
    if entry is not None and _wait_gone(entry):
        entry = None
    if entry is not None:
        return Answer(entry.run, found=True)
    if request.master_uri:
        os.environ.update({"ROS_MASTER_URI": request.master_uri, "ROS_HOSTNAME": request.host})
        os.environ.pop("ROS_IP", None)
    running = _find_running(request)
    if request.nodes and len(running) == len(request.nodes):
        return Answer(running=running)
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        # Files: a pipe would be kept open by what lives on.
        process = subprocess.Popen(
            [*_scope(), sys.executable, "-m", "ur", *launch_words(request, running)],
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=err,
        )
        try:
            code = process.wait(START_SECONDS)
        except subprocess.TimeoutExpired:
            process.terminate()
            return Answer(running=running, problem=f"error: it did not start within {START_SECONDS:g} s")
        out.seek(0)
        err.seek(0)
        if code:
            return Answer(running=running, problem=err.read() or f"error: it ended with exit code {code}")
        return Answer(out.read().strip(), running=running)


def end(request: Request) -> Answer:
    """End the part's run, where it runs."""
    entry = _find(request)
    if entry is None:
        return Answer()
    until = time.monotonic() + END_SECONDS
    with suppress(subprocess.TimeoutExpired):
        command = [sys.executable, "-m", "ur", "stop", entry.run]
        subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=END_SECONDS, check=False)
    gone = _wait_exit(entry, until)  # its process ends a little later than its last word
    return Answer(entry.run, problem="" if gone else f"error: it has not ended within {END_SECONDS:g} s")


def _find(request: Request) -> RunEntry | None:
    for entry in list_runs(os.environ, os.getuid(), socket.gethostname()):
        with suppress(OSError):
            words = Path(f"/proc/{entry.pid}/cmdline").read_bytes().decode(errors="replace").split("\0")
            if is_marked(words[:-1], request):
                return entry
    return None


def _wait_gone(entry: RunEntry) -> bool:
    """Whether a run is about to end, or has ended just now; then it is waited for."""
    try:
        with connect_run(entry.folder) as client:
            for event in iterate_events(client, 5.0):
                if isinstance(event, RunStopping):
                    break
                if isinstance(event, Synchronised):
                    return False
    except RunGone:
        pass
    return _wait_exit(entry, time.monotonic() + END_SECONDS)


def _wait_exit(entry: RunEntry, until: float) -> bool:
    while read_birth(entry.pid) == entry.born:
        if time.monotonic() > until:
            return False
        time.sleep(0.05)
    return True


def _find_running(request: Request) -> tuple[str, ...]:
    try:
        master = parse_master_uri(os.environ.get("ROS_MASTER_URI", "http://localhost:11311"))
        return tuple(master.find_live_nodes(request.nodes)) if request.nodes else ()
    except (Unanswered, Refused):
        return ()


def _scope() -> list[str]:
    """What puts the run under the user's own service manager, where that outlives their sessions: else nothing.

    Without lingering the manager ends with the last session, and all of its services with it; what a session left
    behind does not.
    """
    if not shutil.which("systemd-run") or not Path(f"/run/user/{os.getuid()}/systemd/private").exists():
        return []
    asked = subprocess.run(
        ["loginctl", "show-user", "-P", "Linger", str(os.getuid())], capture_output=True, text=True, check=False
    )
    if asked.stdout.strip() != "yes":
        return []
    os.environ.setdefault("XDG_RUNTIME_DIR", f"/run/user/{os.getuid()}")
    return ["systemd-run", "--user", "--scope", "--quiet", "--collect"]


def main() -> None:
    """Answer the request on standard input."""
    request = parse_request(sys.stdin.read())
    answer = begin(request) if request.action == "begin" else end(request)
    sys.stdout.write("\n" + json.dumps(asdict(answer)) + "\n")


if __name__ == "__main__":
    main()
