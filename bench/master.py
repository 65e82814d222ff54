"""A ROS master for a bench."""

import os
import socket
import subprocess
import time


def start_master(directory: str) -> subprocess.Popen[bytes]:
    """A master on a free port, which this process and its children use; logs go to `directory`."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        port = probe.getsockname()[1]
    os.environ.update(
        ROS_MASTER_URI=f"http://localhost:{port}", ROS_HOSTNAME="localhost", ROS_HOME=directory, ROS_LOG_DIR=directory
    )
    master = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL)
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        with socket.socket() as probe:
            if probe.connect_ex(("localhost", port)) == 0:
                return master
        time.sleep(0.05)
    master.terminate()
    raise SystemExit("error: rosmaster did not start within 20 s, expected package python3-rosmaster to be installed")
