"""A ROS master for a test, processes that end with it, and a client process to talk to them in JSON."""

import contextlib
import json
import os
import secrets
import select
import socket
import subprocess
import time
import xmlrpc.client
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]


def free_port() -> int:
    """A port of this computer that nothing listens on, and that no program gets which asks the kernel for any port."""
    low = int(Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split()[0])
    while True:
        port = secrets.choice(range(max(1024, low - 16_384), low))  # forks share a seed
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(("", port))
            return port


def wait_for_port(port: int, limit: float = 60.0) -> None:
    """Wait until something listens on a port of this computer."""
    deadline = time.monotonic() + limit
    while True:
        with socket.socket() as probe:
            if probe.connect_ex(("localhost", port)) == 0:
                return
        assert time.monotonic() < deadline, f"nothing listens on port {port} after {limit:g} s"
        time.sleep(0.02)


class Client:
    """A client process that answers requests, one JSON object a line (`tests/json_client.py`)."""

    def __init__(self, process: subprocess.Popen[str], limit: float = 90.0) -> None:
        """`limit` is the time in s for an answer, besides that for which the request itself waits (`seconds`)."""
        self.client = process
        self._limit = limit

    def ask(self, do: str, **values: Any) -> Any:
        """The client's answer; fails on an error."""
        answer = self.try_to(do, **values)
        assert "error" not in answer, f"{do}: {answer['error']}{self.explain()}"
        return answer["answer"]

    def try_to(self, do: str, **values: Any) -> dict[str, Any]:
        """The client's answer or its error."""
        assert self.client.stdin
        assert self.client.stdout
        self.client.stdin.write(json.dumps({"do": do, **values}) + "\n")
        self.client.stdin.flush()
        limit = self._limit + float(values.get("seconds", 0.0)) * 3
        ready, _, _ = select.select([self.client.stdout], [], [], limit)
        assert ready, f"{do}: no answer within {limit:g} s{self.explain()}"
        answer: dict[str, Any] = json.loads(self.client.stdout.readline())
        return answer

    def explain(self) -> str:
        """More about a failure, such as the end of a log."""
        return ""


class RosSession:
    """Starts a master on a free port. `close` ends it and everything that `start` started.

    `client` is a command that reads one JSON request a line (`do`, and its arguments) and answers with one line:
    `{"answer": ...}` or `{"error": text}`. rospy can be started only once in a process, so it is a process of its own.
    """

    def __init__(self, folder: Path, client: Sequence[str] = ()) -> None:
        port = free_port()
        kept = {name: value for name, value in os.environ.items() if not name.startswith("ROS")}
        self.env = kept | {
            "ROS_MASTER_URI": f"http://localhost:{port}",
            "ROS_HOSTNAME": "localhost",
            "ROS_HOME": str(folder),
            "ROS_LOG_DIR": str(folder / "log"),
            "PYTHONPATH": os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH", "")))),
        }
        self.running: list[subprocess.Popen[str]] = []
        self.start("/usr/bin/rosmaster", "--core", "-p", str(port))
        wait_for_port(port)
        self._client = Client(self.start(*client)) if client else None

    def start(self, *command: str) -> subprocess.Popen[str]:
        pipe = subprocess.PIPE
        process = subprocess.Popen(command, env=self.env, stdin=pipe, stdout=pipe, stderr=pipe, text=True)
        self.running.append(process)
        return process

    def stop(self, process: subprocess.Popen[str]) -> str:
        """End a process; what it wrote to standard error."""
        process.terminate()
        _, errors = process.communicate(timeout=60)
        self.running.remove(process)
        return errors

    def published(self) -> set[tuple[str, str]]:
        """Topics that some node publishes, with their types."""
        with xmlrpc.client.ServerProxy(self.env["ROS_MASTER_URI"]) as master:
            answer: Any = master.getPublishedTopics("/test", "")
        return {(name, kind) for name, kind in answer[2]}

    def close(self) -> None:
        for process in reversed(list(self.running)):
            self.stop(process)

    def ask(self, do: str, **values: Any) -> Any:
        """The client's answer; fails on an error."""
        assert self._client, "made without a client"
        return self._client.ask(do, **values)

    def try_to(self, do: str, **values: Any) -> dict[str, Any]:
        """The client's answer or its error."""
        assert self._client, "made without a client"
        return self._client.try_to(do, **values)
