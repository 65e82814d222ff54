"""A node of ROS 1 that is ended while it speaks to its master for the first time, or while it ends already."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from xmlrpc.server import SimpleXMLRPCServer

import pytest

pytestmark = [pytest.mark.ros, pytest.mark.timeout(120)]


class SlowMaster:
    """A master that answers the first parameter of a node when it is released."""

    def __init__(self) -> None:
        self.asked, self.released = threading.Event(), threading.Event()
        self._server = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False, allow_none=True)
        self._server.register_instance(self)
        self._thread = threading.Thread(target=self._server.serve_forever)
        self._thread.start()

    @property
    def uri(self) -> str:
        return f"http://127.0.0.1:{self._server.server_address[1]}"

    def _dispatch(self, method: str, _arguments: tuple[object, ...]) -> tuple[int, str, object]:
        if method == "setParam":
            self.asked.set()
            self.released.wait()
        return 1, "", [] if method.startswith("register") else 0

    def close(self) -> None:
        self.released.set()
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()


@pytest.fixture
def master() -> Iterator[SlowMaster]:
    master = SlowMaster()
    yield master
    master.close()


def test_node_ends_that_is_ended_while_it_sets_its_parameters(master: SlowMaster, tmp_path: Path) -> None:
    environment = {
        **os.environ,
        "ROS_MASTER_URI": master.uri,
        "ROS_LOG_DIR": str(tmp_path),
        "ROS_HOSTNAME": "localhost",
    }
    command = [sys.executable, "-I", "-m", "ur_nodes", "ur_nodes.motion.joystick.joy_node", "_rate:=1"]
    node = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)
    try:
        if not master.asked.wait(60):
            node.kill()
            raise AssertionError(f"the node did not ask its master: {node.communicate()[1]}")
        node.send_signal(signal.SIGTERM)
        master.released.set()
        node.communicate(timeout=60)  # it ends
    finally:
        node.kill()
        node.wait()
    assert node.returncode in (0, 2, -signal.SIGTERM)


def test_node_ends_that_is_ended_while_it_looks_for_a_master(tmp_path: Path) -> None:
    environment = {**os.environ, "ROS_MASTER_URI": "http://localhost:1", "ROS_LOG_DIR": str(tmp_path)}
    command = [sys.executable, "-I", "-u", "-m", "ur_nodes", "ur_nodes.motion.joystick.joy_node"]
    node = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert node.stdout is not None
    lines = [""]
    try:
        while "Unable to register" not in lines[-1]:
            lines.append(node.stdout.readline())
            assert lines[-1], f"it ended by itself: {''.join(lines)}"
        node.send_signal(signal.SIGTERM)
        node.communicate(timeout=60)  # it ends
    finally:
        node.kill()
        node.wait()
    assert node.returncode == -signal.SIGALRM


ENDING = """
import os, signal, sys, time
from ur_nodes.run import run

def start(node):
    def end():
        for _ in range(50):  # systemd and Ctrl-C interrupt what ends already
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.01)
        print("has stopped its motors", flush=True)
    node.on_end(end)
    node.after(0.0, lambda: print("runs", flush=True))

sys.exit(run("ending", start))
"""


def test_further_signals_do_not_cut_off_what_a_node_does_at_its_end(master: SlowMaster, tmp_path: Path) -> None:
    master.released.set()
    program = tmp_path / "ending_node.py"
    program.write_text(ENDING)
    environment = {
        **os.environ,
        "ROS_MASTER_URI": master.uri,
        "ROS_LOG_DIR": str(tmp_path),
        "ROS_HOSTNAME": "localhost",
    }
    command = [sys.executable, "-I", "-u", "-m", "ur_nodes", str(program)]
    with subprocess.Popen(command, env=environment, text=True, stdout=subprocess.PIPE) as node:
        try:
            assert node.stdout is not None
            assert node.stdout.readline() == "runs\n"
            node.send_signal(signal.SIGTERM)  # the host was killed
            rest, _ = node.communicate(timeout=60)
        finally:
            node.kill()
    assert rest == "has stopped its motors\n"
