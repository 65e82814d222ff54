"""A package of little nodes, a port of its own, and `ur launch` as a process."""

from __future__ import annotations

import os
import pty
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import psutil
import pytest
from tests.forking import ForkedProcess, python_of_ros, python_of_ur
from tests.ros_session import free_port

NODES = {
    "sleeper": "#!/bin/bash\nexec sleep 600\n",
    "stubborn": "#!/bin/bash\ntrap '' INT TERM\necho trapped >&2\nwhile :; do sleep 0.2; done\n",
    "daemon": "#!/bin/bash\n(setsid sleep 600 >/dev/null 2>&1 &) \nexec sleep 600\n",
    "crash": "#!/bin/bash\necho first words\necho last words >&2\nexit 3\n",
    "segfault": "#!/bin/bash\necho about to fault\nkill -SEGV $$\n",
    "quick": '#!/bin/bash\necho "$@"\nexit 0\n',
    "show": '#!/bin/bash\necho "args: $*"\necho "cwd: $PWD"\necho "ns: ${ROS_NAMESPACE-none}"\n'
    'echo "mine: ${MINE-none}"\necho "uri: $ROS_MASTER_URI"\nexec sleep 600\n',
    "ask": '#!/bin/bash\nwhile read -r line; do echo "got $line"; done\nexit 7\n',
    "echo": "#!/usr/bin/python3\nimport sys\nfor line in sys.stdin:\n    print('got', line, end='', flush=True)\n",
    "screen": "#!/bin/bash\nstty -echo -icanon\nprintf 'ready\\n'\nread -r line\necho \"got $line\"\nexit ${1:-0}\n",
    "raw": "#!/bin/bash\nstty raw -echo\nprintf '\\033[?1049h\\033[?25l'\nprintf 'ready\\n'\nexec sleep 600\n",
    "ticker": "#!/bin/bash\nwhile :; do echo tick; sleep 0.05; done\n",
    "refuse": "#!/bin/bash\necho 'speed: expected a number' >&2\nexit 2\n",
    "flood": "#!/bin/bash\nexec seq -f '%.0f 0123456789' 100000000\n",
    "noisy": "#!/bin/bash\nseq -f 'line %.0f of many that together are larger than a small disk' 300\nexec sleep 600\n",
    "binary": "#!/usr/bin/python3\nimport sys\nsys.stdout.buffer.write(bytes(range(256)) * 40"
    " + b'\\x1b[2J\\x1b]0;title\\x07\\n')\n",
    "double": "#!/usr/bin/python3\nimport os, time\nif os.fork() == 0:\n    os.setsid()\n    if os.fork() == 0:\n"
    "        os.execlp('sleep', 'sleep', '600')\n    os._exit(0)\nos.execlp('sleep', 'sleep', '600')\n",
    "deaf": "#!/usr/bin/python3\nimport os, signal\nfor number in range(1, 32):\n    if number not in (9, 17, 19):\n"
    "        signal.signal(number, signal.SIG_IGN)\nos.execlp('sleep', 'sleep', '600')\n",
    "talker": "#!/usr/bin/python3\nimport rospy, std_msgs.msg\nrospy.init_node('talker')\n"
    "rospy.Publisher('chat', std_msgs.msg.String, queue_size=1)\nprint('up', flush=True)\nrospy.spin()\n",
}
# As the script `ur` starts it, on a terminal: an interrupt that comes before its first line waits for that.
BLOCKED = ("/usr/bin/env", "--block-signal=INT")
MANIFEST = (
    '<package format="2"><name>little_nodes</name><version>0.0.1</version><description>For tests.</description>'
    '<maintainer email="nobody@example.invalid">Nobody</maintainer><license>BSD</license></package>'
)


def parent_of(pid: int) -> int:
    """The parent of a process; 0: it has ended."""
    with suppress(OSError):
        return int(Path("/proc", str(pid), "stat").read_bytes().rpartition(b")")[2].split()[1])
    return 0


@dataclass
class Launched:
    """A running `ur`, its output so far, and every process that was ever seen below it."""

    process: subprocess.Popen[bytes] | ForkedProcess
    output: int
    keeper: int = -1  # the other end of its terminal
    text: str = ""
    seen: dict[int, psutil.Process] = field(default_factory=dict)
    others: set[int] = field(default_factory=set)  # processes that are not below it

    def read(self, patience: float = 0.05) -> bool:
        self.look()
        if self.output < 0 or not select.select([self.output], [], [], patience)[0]:
            return False
        try:
            data = os.read(self.output, 65536)
        except OSError:
            data = b""
        if not data:
            os.close(self.output)
            self.output = -1
        self.text += data.decode("utf-8", "replace")
        return bool(data)

    def look(self) -> None:
        """Note the processes below it that are new; those of others are not looked at twice."""
        running = {int(name) for name in os.listdir("/proc") if name.isdigit()}  # noqa: PTH208 - names, not paths
        parents = {pid: parent_of(pid) for pid in running - self.others - self.seen.keys() - {self.process.pid}}
        while found := [pid for pid, parent in parents.items() if parent == self.process.pid or parent in self.seen]:
            for pid in found:
                del parents[pid]
                with suppress(psutil.NoSuchProcess):
                    self.seen[pid] = psutil.Process(pid)
        self.others = (self.others & running) | {pid for pid, parent in parents.items() if parent}

    def until(self, *texts: str, limit: float = 60.0) -> None:
        """Wait until every text was printed."""
        end = time.monotonic() + limit
        while not all(text in self.text for text in texts):
            assert time.monotonic() < end, f"expected {texts} in:\n{self.text}"
            assert self.read() or self.output >= 0, f"ended without {texts}:\n{self.text}"
        self.look()

    def wait(self, limit: float = 60.0) -> int:
        """Wait for its end; return the exit code."""
        end = time.monotonic() + limit
        while self.process.poll() is None:
            assert time.monotonic() < end, f"still running:\n{self.text}"
            self.read()
        while self.read(0):
            pass
        assert self.process.returncode is not None
        return self.process.returncode

    def survivors(self) -> list[str]:
        """The command lines of those that still run."""
        found = []
        for each in self.seen.values():
            with suppress(psutil.Error):  # it ended just now
                if each.is_running() and each.status() != psutil.STATUS_ZOMBIE:
                    found.append(" ".join(each.cmdline()))
        return found

    def until_running(self, command: str, count: int, limit: float = 60.0) -> None:
        """Wait until so many processes have this command line."""
        end = time.monotonic() + limit
        while self.survivors().count(command) < count:
            assert time.monotonic() < end, self.survivors()
            self.read(0.01)

    def wait_nothing_left(self, limit: float = 60.0) -> None:
        """Wait until no process that it ever had runs any more."""
        end = time.monotonic() + limit
        while left := self.survivors():
            assert time.monotonic() < end, left
            time.sleep(0.01)


@dataclass
class RunWorld:
    """What tests start `ur` in."""

    folder: Path
    environment: dict[str, str]
    port: int
    running: list[Launched] = field(default_factory=list)
    master_pid: int = 0  # of a master that somebody else runs

    def write(self, body: str, name: str = "test.launch") -> str:
        path = self.folder / name
        path.write_text(f"<launch>{body}</launch>", encoding="utf-8")
        return str(path)

    def ur(self, *words: str, stdin: int = subprocess.DEVNULL, terminal: bool = False) -> Launched:
        """Start `ur`; with `terminal` on a pseudo terminal of its own, as the leader of its session.

        Without, it is a fork of an interpreter, where signals during the start of Python cannot be seen: see `execute`.
        """
        if terminal:
            return self.execute(*words, terminal=True)
        reader, end = os.pipe()
        streams = (stdin, end, end)
        process = python_of_ur().start(
            "ur", *words, folder=self.folder, environment=self.environment, streams=streams, blocked=True
        )
        os.close(end)
        self.running.append(launched := Launched(process, reader))
        return launched

    def execute(self, *words: str, terminal: bool = False) -> Launched:
        """Start `ur` likewise, by a start of Python."""
        return self.start([*BLOCKED, sys.executable, "-m", "ur", *words], terminal=terminal)

    def start(self, command: list[str], *, terminal: bool = False) -> Launched:
        """Start a command likewise."""
        if terminal:
            controller, end = pty.openpty()
            process = subprocess.Popen(
                command,
                stdin=end,
                stdout=end,
                stderr=end,
                env=self.environment,
                cwd=self.folder,
                preexec_fn=_own_terminal,
            )
            launched = Launched(process, controller, end)
        else:
            reader, end = os.pipe()
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=end,
                stderr=end,
                env=self.environment,
                cwd=self.folder,
                preexec_fn=_hear_signals,
            )
            os.close(end)
            launched = Launched(process, reader)
        self.running.append(launched)
        return launched

    def call(self, *words: str, code: int = 0) -> str:
        """What `ur` prints, which ends with an exit code."""
        done = self.ur(*words)
        assert done.wait() == code, done.text
        return str(done.text)

    def launch(self, body: str, *words: str, **how: bool) -> Launched:
        return self.ur("launch", self.write(body), *words, **how)


def _hear_signals() -> None:
    for number in (signal.SIGHUP, signal.SIGINT):
        signal.signal(number, signal.SIG_DFL)


def _own_terminal() -> None:
    import fcntl
    import termios

    _hear_signals()
    os.setsid()
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


@pytest.fixture
def world(tmp_path: Path) -> Iterator[RunWorld]:
    package = tmp_path / "little_nodes"
    (package / "nodes").mkdir(parents=True)
    (package / "package.xml").write_text(MANIFEST)
    for name, text in NODES.items():
        (package / "nodes" / name).write_text(text)
        (package / "nodes" / name).chmod(0o755)
    port = free_port()
    relay = Path("/usr/lib/topic_tools/relay")  # a small C++ node
    (package / "nodes" / "relay").symlink_to(relay if relay.exists() else package / "nodes" / "sleeper")
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith("ROS_") and name != "DISPLAY"
    }
    environment |= {
        "HOME": str(tmp_path),
        "XDG_CONFIG_HOME": str(tmp_path / "config"),
        "XDG_STATE_HOME": str(tmp_path / "state"),
        "ROS_MASTER_URI": f"http://localhost:{port}",
        "ROS_HOSTNAME": "localhost",
        "ROS_HOME": str(tmp_path / "ros"),
        "ROS_PACKAGE_PATH": str(package),
    }
    environment.pop("WAYLAND_DISPLAY", None)
    made = RunWorld(tmp_path, environment, port)
    yield made
    for launched in made.running:
        launched.look()
        if launched.process.poll() is None:
            launched.process.send_signal(signal.SIGTERM)
            try:
                launched.process.wait(60)
            except subprocess.TimeoutExpired:
                launched.process.kill()
                launched.process.wait()
        for each in launched.seen.values():
            with suppress(psutil.NoSuchProcess):
                each.kill()
        for descriptor in (launched.output, launched.keeper):
            if descriptor >= 0:
                os.close(descriptor)


def start_master(world: RunWorld) -> ForkedProcess:
    """Start a master at the world's address, and wait until it answers."""
    words = ("--core", "-p", str(world.port))
    silent = (subprocess.DEVNULL, subprocess.DEVNULL, subprocess.DEVNULL)
    process = python_of_ros().start(
        "/usr/bin/rosmaster", *words, folder=Path.cwd(), environment=world.environment, streams=silent
    )
    end = time.monotonic() + 60
    while True:
        with socket.socket() as probe:
            if probe.connect_ex(("localhost", world.port)) == 0:
                return process
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture
def master(world: RunWorld) -> Iterator[int]:
    """A master of somebody else at the world's address: its port."""
    process = start_master(world)
    world.master_pid = process.pid
    yield world.port
    process.terminate()
    process.wait(60)
