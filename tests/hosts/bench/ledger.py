"""What a bench has made, written down before it is made, so that whoever comes next can remove it by name."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import signal
import subprocess
import time
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path

from tests.hosts.bench.groups import remove_groups

LEDGERS = Path("/run/ur-hosts")


@dataclass(frozen=True, slots=True)
class Process:
    """A process that is not mistaken for a later one with the same number: `started` is in clock ticks since boot."""

    pid: int
    started: int

    @property
    def alive(self) -> bool:
        """Whether this very process still runs (a zombie does not)."""
        return start_time(self.pid) == self.started


@dataclass(slots=True)
class Ledger:
    """Identifiers of one bench: its owner, bridge, folder, mounts, and machines' processes and control groups."""

    name: str
    owner: Process
    folder: str
    bridge: str = ""
    mounts: list[str] = field(default_factory=list)
    processes: list[Process] = field(default_factory=list)
    groups: list[str] = field(default_factory=list)

    @property
    def path(self) -> Path:
        """Where it is written."""
        return LEDGERS / f"{self.name}.json"

    def save(self) -> None:
        """Write it; complete or not at all."""
        LEDGERS.mkdir(parents=True, exist_ok=True)
        unfinished = self.path.with_suffix(".new")
        unfinished.write_text(json.dumps(asdict(self)))
        unfinished.replace(self.path)

    @classmethod
    def load(cls, path: Path) -> Ledger:
        """Read one that save wrote."""
        record = json.loads(path.read_text())
        record["owner"] = Process(**record["owner"])
        record["processes"] = [Process(**item) for item in record["processes"]]
        return cls(**record)


def this_process() -> Process:
    """The calling process."""
    return find_process(os.getpid())


def find_process(pid: int) -> Process:
    """The process with a number; when there is none, one that is not alive."""
    return Process(pid, start_time(pid) or -1)


def start_time(pid: int) -> int | None:
    """When a process started, in clock ticks since boot (proc(5), stat, field 22); None when it does not run."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return None if fields[0] in ("Z", "X") else int(fields[19])


def remove_stale() -> list[str]:
    """Remove everything of benches whose owner is gone; the names of those benches."""
    LEDGERS.mkdir(parents=True, exist_ok=True)
    with (LEDGERS / "lock").open("w") as lock:  # two that remove the same bench would fail over what is gone already
        fcntl.flock(lock, fcntl.LOCK_EX)
        gone = [ledger for ledger in list_ledgers() if not ledger.owner.alive]
        for ledger in gone:
            remove_all(ledger)
    return [ledger.name for ledger in gone]


def list_ledgers() -> list[Ledger]:
    """The ledgers of all benches on this computer."""
    found = []
    for path in sorted(LEDGERS.glob("*.json")):
        with suppress(FileNotFoundError):  # a bench that ends meanwhile removes its own
            found.append(Ledger.load(path))
    return found


def remove_all(ledger: Ledger) -> None:
    """Remove what a ledger names, in the order that works, and then the ledger. May be called again after a failure."""
    for process in ledger.processes:
        stop(process)
    remove_groups(ledger.groups)
    for mount in reversed(ledger.mounts):
        if os.path.ismount(mount):
            subprocess.run(["umount", "--lazy", mount], check=True, capture_output=True)
    _remove_bridge(ledger.bridge)
    if Path(ledger.folder).exists():
        shutil.rmtree(ledger.folder)
    ledger.path.unlink(missing_ok=True)


def _remove_bridge(name: str) -> None:
    bridge = Path("/sys/class/net", name)
    if not name or not bridge.exists():
        return
    # The kernel removes a dead computer's end of a link when it gets round to it; not leaving is better than soon gone.
    for port in [*(bridge / "brif").iterdir(), bridge]:
        subprocess.run(["ip", "link", "delete", port.name], check=False, capture_output=True)


def stop(process: Process, patience: float = 10.0) -> None:
    """End a computer: its init, which takes all the others along, its systemd-nspawn, and the loop around that."""
    deadline = time.monotonic() + patience
    while process.alive:
        _reap(process.pid)
        for nspawn in children_of(process.pid):
            for init in children_of(nspawn):
                _kill(init)  # then systemd-nspawn ends, and then the loop around it
            if time.monotonic() > deadline:
                _kill(process.pid)
                _kill(nspawn)
        time.sleep(0.02)


def _kill(pid: int) -> None:
    with suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)


def _reap(pid: int) -> None:
    with suppress(ChildProcessError):  # not ours: an earlier bench's
        os.waitpid(pid, os.WNOHANG)


def children_of(pid: int) -> list[int]:
    """The process numbers of a process's children; none when it is gone."""
    try:
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []
