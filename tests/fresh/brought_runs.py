"""Trials of runs in the Debian root: the terminal, signals, what is left after them, and the time of a start."""

import os
import pty
import re
import select
import signal
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

from tests.fresh.brought_commands import NODES, PATIENCE, UR, inside, launch_file, processes, run, wait_for

# Not a loop of bash: its `read -t` loses characters and signals on a busy computer.
ECHO = """\
import os, signal
signal.signal(signal.SIGINT, signal.SIG_DFL)
signal.signal(signal.SIGWINCH, lambda *_: print(os.popen("stty size").read(), flush=True))
print("started", flush=True)
while True:
    print("got", input(), flush=True)
"""


def trial_terminal() -> str:
    """Ctrl-C, Ctrl-Z, fg, bg and a new size of the terminal pass through."""
    import fcntl
    import struct
    import termios

    pid, terminal = pty.fork()
    if pid == 0:
        os.execvp("bash", ["bash", "--norc", "--noprofile", "-i"])
    said = ""
    script = tempfile.NamedTemporaryFile("w", dir=Path.home(), suffix=".py")  # noqa: SIM115 - closed below
    script.write(ECHO)
    script.flush()

    def expect(pattern: str) -> None:
        nonlocal said
        end = time.monotonic() + PATIENCE
        while not re.search(pattern, said):
            assert time.monotonic() < end, (pattern, said)
            if select.select([terminal], [], [], 0.2)[0]:
                said += os.read(terminal, 65536).decode(errors="replace")
        said = said[re.search(pattern, said).end() :]  # type: ignore[union-attr]

    def type_in(text: str) -> None:
        os.write(terminal, text.encode())

    try:
        type_in("PS1='rea''dy> '\n")
        expect("ready> ")
        type_in(f"{UR} setup debian shell python3 {script.name}\n")
        expect("started")
        type_in("one\n")
        expect("got one")
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 33, 111, 0, 0))
        expect("33 111")
        type_in("\x1a")
        expect("Stopped")
        expect("ready> ")
        type_in("jobs\n")
        expect("Stopped")
        type_in("fg\n")
        time.sleep(0.3)
        type_in("two\n")
        expect("got two")
        type_in("\x03")
        expect("ready> ")
        type_in("echo code=$?\n")
        expect("code=130")
    finally:
        script.close()
        os.kill(pid, signal.SIGKILL)
        os.close(terminal)
        os.waitpid(pid, 0)
    return "read, resize, Ctrl-Z, jobs, fg, Ctrl-C (code 130)"


def trial_kill() -> str:
    """After kill -9 of the process outside no node runs."""
    mark = f"doze-{os.getpid()}"
    with launch_file(mark, NODES) as path:
        process = subprocess.Popen([UR, "launch", str(path)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_for(lambda: len(processes(mark)) >= NODES, f"{NODES} nodes")
        process.kill()
        process.wait()
        time.sleep(2)
        left = processes(mark)
    assert not left, f"{len(left)} of {NODES} nodes still run 2 s after kill -9"
    return f"{len(left)} of {NODES} nodes 2 s after kill -9"


def trial_interrupt() -> str:
    """Ctrl-C ends a run with its nodes; a second command sees and ends the run of a first."""
    mark = f"doze2-{os.getpid()}"
    with launch_file(mark, 3) as path:
        process = subprocess.Popen([UR, "launch", str(path)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_for(lambda: len(processes(mark)) >= 3, "3 nodes")
        assert "fifty" in run(UR, "ps").stdout
        assert Path(f"/proc/{process.pid}/exe").readlink().name.startswith("python"), "it is another process"
        other = inside(f"readlink /proc/{process.pid}/exe && readlink /proc/{process.pid}/cwd")
        assert other.returncode == 0, f"a second command cannot inspect the first: {other.stderr}"
        process.send_signal(signal.SIGINT)
        code = process.wait(PATIENCE)
        assert not processes(mark)
        second = subprocess.Popen([UR, "launch", str(path)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_for(lambda: len(processes(mark)) >= 3, "3 nodes")
        stopped = run(UR, "stop", "--all")
        assert stopped.returncode == 0, stopped.stderr
        second.wait(PATIENCE)
        assert not processes(mark)
    return f"SIGINT: exit code {code}; ur ps and ur stop from another command"


def trial_start() -> str:
    """Time of `ur launch --nodes` from outside, and of the same in the root already."""
    with launch_file("doze", NODES) as path:
        question = ["launch", "--nodes", str(path)]
        outside, within = [], []
        timed = f"s=$EPOCHREALTIME; {UR} {' '.join(question)} >/dev/null; e=$EPOCHREALTIME"
        script = f"for i in 1 2 3; do {timed}; echo $(((${{e/./}}-${{s/./}}))); done"
        for _ in range(7):
            outside += [int(each) / 1000 for each in subprocess.check_output(["bash", "-c", script]).split()]
            within += [int(each) / 1000 for each in inside(script).stdout.split()]
    more = statistics.median(outside) - statistics.median(within)
    least = min(outside) - min(within)
    figures = f"outside {statistics.median(outside):.0f} ms, inside {statistics.median(within):.0f} ms"
    assert min(more, least) <= 60, f"{figures}: {more:.0f} ms more (minimum: {least:.0f} ms more), expected at most 60"
    return f"{figures}: {more:.0f} ms more (minimum: {least:.0f} ms more), median of {len(outside)}"
