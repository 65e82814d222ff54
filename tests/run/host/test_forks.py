"""Nodes that are forked from one process: the host and `ur_nodes.fork_server` together, without ROS."""

import socket
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import cast

from ur.run.host.fork import ProcessCreator
from ur.run.host.forks import NodeForks
from ur.run.host.protocol import send

NODE = """import os, sys
import shared
if __name__ == "__main__":
    with open("/proc/self/cmdline", "rb") as file:
        command = file.read().rstrip(b"\\0").decode().split("\\0")
    print("shared", shared.MADE_BY != os.getpid(), "leads", os.getpgid(0) == os.getpid(), os.getsid(0) == os.getpid())
    print("is", *sys.argv[1:], "in", os.getcwd(), "with", os.environ.get("GIVEN"), os.environ.get("TAKEN"))
    print("shown as", *command[4:], flush=True)
    if "wait" in sys.argv:
        import signal
        signal.pause()
    raise SystemExit(5)
"""
# In a process of its own: whoever starts a host inherits orphans from then on.
DRIVER = """
import os, signal, sys
from ur.run.process.host_client import start_host
from ur.run.supervisor.events import Exited, Started
folder = sys.argv[1]
host = start_host()
null = os.open(os.devnull, os.O_RDWR)
server = (sys.executable, "-I", "-m", "ur_nodes", "ur_nodes.fork_server", folder, "little")
environment = {"PATH": "/usr/bin:/bin", "PYTHONPATH": folder, "ROS_VERSION": "0", "TAKEN": "no"}
host.begin(environment, keep_terminal=False, server=server)

def start(name, *arguments, mode="group"):
    with open(f"{folder}/{name}", "wb") as file:
        words = ("little", *arguments)
        changes = {"GIVEN": name, "TAKEN": None}
        host.start_process(name, ["/bin/echo", "executed"], folder, changes, (null, file.fileno(), null), mode, words)

def receive():
    event = host.receive()
    if isinstance(event, Started):
        print("started", event.name, flush=True)
        return event.pid
    print("exited", event.name, event.status.code, event.status.signal, flush=True)

def parent(pid):
    with open(f"/proc/{pid}/stat") as file:
        return int(file.read().rpartition(")")[2].split()[1])
"""


def drive(folder: Path, script: str, shared: str = "") -> list[str]:
    """Run a script with a host; return what it printed. `shared` is done where a module of the node is imported."""
    (folder / "little.py").write_text(NODE)
    (folder / "shared.py").write_text(f"import os\nMADE_BY = os.getpid()\n{shared}")
    command = [sys.executable, "-c", DRIVER + script + "\nhost.close()\n", str(folder)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout.splitlines()


def test_forked_node_has_session_folder_environment_and_arguments_of_its_own(tmp_path: Path) -> None:
    lines = drive(tmp_path, "start('one', 'a', '__name:=one')\nreceive()\nreceive()\n")
    assert lines == ["started one", "exited one 5 None"]
    assert (tmp_path / "one").read_text().splitlines() == [
        "shared True leads True False",
        f"is a __name:=one in {tmp_path} with one None",
        "shown as little a __name:=one",
    ]


def test_forked_node_leads_a_session_where_that_is_requested(tmp_path: Path) -> None:
    drive(tmp_path, "start('one', mode='session')\nreceive()\nreceive()\n")
    assert (tmp_path / "one").read_text().splitlines()[0] == "shared True leads True True"


def test_signal_reaches_a_forked_node_and_its_end_is_reported(tmp_path: Path) -> None:
    script = """
start('one', 'wait')
print("mine", parent(receive()) == os.getpid())
host.signal_process('one', signal.SIGTERM)
receive()
"""
    assert drive(tmp_path, script) == ["started one", "mine False", "exited one None 15"]


def test_page_gets_a_node_of_the_run_and_one_that_says_nothing_delays_no_other(tmp_path: Path) -> None:
    script = """
import socket
from ur.web.server.robot_process import fork_node
start('one', 'wait')
above = parent(receive())
silent = socket.socket(socket.AF_UNIX)
silent.connect(folder + "/forks")
with open(f"{folder}/page", "wb") as file:
    pid = fork_node(folder + "/forks", "little", (null, file.fileno(), null), {"GIVEN": "page"})
print("sibling", parent(pid) == above, flush=True)
while os.path.exists(f"/proc/{pid}"):
    pass
host.signal_process('one', signal.SIGKILL)
receive()
"""
    assert drive(tmp_path, script) == ["started one", "sibling True", "exited one None 9"]
    assert (tmp_path / "page").read_text().splitlines() == [
        "shared True leads True True",
        "is 0 1 in / with page None",
        "shown as little 0 1",
    ]


def test_page_is_refused_where_the_server_cannot_fork_and_no_file_of_its_node_stays_open(tmp_path: Path) -> None:
    script = """
import select
from ur.web.server.robot_process import fork_node
refusals = 0
while refusals < 2:
    reader, writer = os.pipe()
    try:
        fork_node(folder + "/forks", "little", (null, null, writer), {})
    except (FileNotFoundError, ConnectionRefusedError):  # it does not listen yet
        os.close(reader)
        os.close(writer)
    except EOFError:
        refusals += 1
        os.close(writer)
        print("refused", select.select([reader], [], [], 60)[0] == [reader], flush=True)
start('one')
receive()
receive()
"""
    cannot = "def cannot():\n    raise BlockingIOError(11, 'no processes')\nos.fork = cannot\n"
    assert drive(tmp_path, script, cannot) == ["refused True"] * 2 + ["started one", "exited one 0 None"]
    assert (tmp_path / "one").read_text() == "executed\n"


def test_no_file_stays_open_where_the_server_cannot_be_started() -> None:
    class Full(ProcessCreator):
        def create(self, *_: object) -> int:
            raise BlockingIOError(11, "no processes")

    creator, forks = Full(), NodeForks()
    before = set(Path("/proc/self/fd").iterdir())
    forks.begin(creator, ("/bin/true",), {})
    assert (forks.fileno(), set(Path("/proc/self/fd").iterdir())) == (-1, before)


def test_node_whose_server_was_killed_is_executed_instead(tmp_path: Path) -> None:
    script = """
start('one', 'wait')
one = receive()
for each in filter(str.isdigit, os.listdir("/proc")):
    try:
        with open(f"/proc/{each}/cmdline", "rb") as command:  # a node has that of its server until it runs
            if int(each) != one and parent(each) == parent(one) and b"fork_server" in command.read():
                os.kill(int(each), signal.SIGKILL)
    except OSError:
        pass
start('two')
receive()
receive()
host.signal_process('one', signal.SIGINT)
receive()
"""
    assert drive(tmp_path, script) == [
        "started one",
        "started two",
        "exited two 0 None",
        "exited one 130 None",
    ]
    assert (tmp_path / "two").read_text() == "executed\n"


def test_forked_nodes_end_with_the_host(tmp_path: Path) -> None:
    script = """
import select
start('one', 'wait')
watch = os.pidfd_open(receive())
host.close()
print("ended", select.select([watch], [], [], 60)[0] == [watch])
"""
    assert drive(tmp_path, script) == ["started one", "ended True"]


def test_message_with_files_is_sent_though_its_receiver_closes_at_once() -> None:
    ours, theirs = socket.socketpair()

    def send_to_the_end(data: list[bytes], _files: object) -> int:
        ours.sendall(data[0])
        theirs.close()
        return len(data[0])

    with ours:
        send(cast(socket.socket, SimpleNamespace(sendmsg=send_to_the_end, sendall=ours.sendall)), ("one",), (0,))


def test_nodes_are_executed_where_no_server_runs() -> None:
    forks = NodeForks()
    assert not forks.request(("one", ["/bin/true"], "/", {}, "group", []), ("little",))
    assert forks.fileno() == -1
    assert forks.end() == []


def test_forked_nodes_end_with_a_host_that_is_killed(tmp_path: Path) -> None:
    script = """
import select
start('one', 'wait')
pid = receive()
watch = os.pidfd_open(pid)
os.kill(parent(pid), signal.SIGKILL)
print("ended", select.select([watch], [], [], 60)[0] == [watch])
"""
    assert drive(tmp_path, script) == ["started one", "ended True"]
