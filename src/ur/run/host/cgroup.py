"""A separate control group (cgroup v2) for a run, where permitted: its processes cannot leave it.

It includes processes that signals do not reach: those that run as another user, or whose ancestors were all killed at
once. Root may create one, and other users where systemd has delegated theirs: `systemd-run --user --scope ur launch
...`, most graphical terminals, a user's own services. Elsewhere (a session over ssh) a run has none. Source:
Documentation/admin-guide/cgroup-v2.rst of the Linux kernel.
"""

import os
import select
import time

from ur.run.host.signals import signal

PREFIX = "ur-"


class Cgroup:
    """A control group that this process has created without joining it."""

    def __init__(self, path: str) -> None:
        """Create the object for its folder."""
        self.path = path

    def add(self, pid: int) -> None:
        """Move a process into the group, which its later children inherit. No effect without permission.

        This may take tens of ms, during which no process on this computer can fork: the kernel waits for all
        processors.
        """
        self._write("cgroup.procs", str(pid))

    def list_processes(self) -> list[int]:
        """Return the ids of the processes in it."""
        try:
            with open(f"{self.path}/cgroup.procs", encoding="ascii") as file:  # noqa: PTH123 - pathlib is slow to import
                return [int(line) for line in file]
        except OSError:
            return []

    def kill(self) -> None:
        """SIGKILL all its processes at once, so that none can fork in between."""
        if self._write("cgroup.kill", "1"):
            return
        for pid in self.list_processes():  # Linux before 5.14
            try:
                os.kill(pid, signal.SIGKILL)
            except OSError:  # noqa: PERF203 - one that has just ended must not save the others
                continue

    def remove(self, limit: float) -> bool:
        """Remove the group once it is empty; return False if it is not empty after a time limit (s)."""
        end = time.monotonic() + limit
        while not self._remove_empty():
            if time.monotonic() > end:
                return False
            select.select([], [], [], 0.01)
        return True

    def _remove_empty(self) -> bool:
        try:
            os.rmdir(self.path)  # noqa: PTH106 - likewise
        except FileNotFoundError:
            return True
        except OSError:
            return False
        return True

    def _write(self, name: str, text: str) -> bool:
        try:
            descriptor = os.open(f"{self.path}/{name}", os.O_WRONLY | os.O_CLOEXEC)
        except OSError:
            return False
        try:
            os.write(descriptor, text.encode())
        except OSError:
            return False
        finally:
            os.close(descriptor)
        return True


def make_cgroup(pid: int) -> Cgroup | None:
    """Create the group of a run, named after its guard's process id; None if that is not possible."""
    parent = _find_own_folder()
    if parent is None:
        return None
    made = Cgroup(f"{parent}/{PREFIX}{pid}")
    try:
        _remove_stale(parent)
        os.mkdir(made.path, 0o755)  # noqa: PTH102 - likewise
    except OSError:
        return None
    return made


def find_cgroup(pid: int) -> Cgroup | None:
    """Find the group that a guard has created beside that of this process."""
    parent = _find_own_folder()
    return None if parent is None else Cgroup(f"{parent}/{PREFIX}{pid}")


def find_group_above() -> str:
    """Return the folder of the group that the supervisor of this process's run is in; '' if the run has none."""
    folder = _find_own_folder() or ""
    above = folder
    while (name := above.rpartition("/")[2]).startswith(PREFIX) and name.removeprefix(PREFIX).isdigit():
        above = above.rpartition("/")[0]
    return "" if above == folder else above


def find_folder(own: str, mounts: str) -> str | None:
    """Return the folder of a process's cgroup (v2), from its /proc/PID/cgroup and mountinfo; None without one."""
    path = next((line[3:] for line in own.splitlines() if line.startswith("0::/")), None)
    if path is None:
        return None
    for line in mounts.splitlines():  # ... root mount-point options ... - type source options, proc(5)
        before, _, after = line.partition(" - ")
        words = before.split()
        if after.split()[:1] != ["cgroup2"] or len(words) < 5:
            continue
        root, point = words[3].rstrip("/"), words[4]
        if path == root or path.startswith(f"{root}/"):
            return (point + path[len(root) :]).rstrip("/")
    return None


def _find_own_folder() -> str | None:
    try:
        with open("/proc/self/cgroup", encoding="utf-8") as file:  # noqa: PTH123 - likewise
            own = file.read()
        with open("/proc/self/mountinfo", encoding="utf-8") as file:  # noqa: PTH123 - likewise
            return find_folder(own, file.read())
    except OSError:
        return None


def _remove_stale(parent: str) -> None:
    """Remove empty groups of guards that were killed."""
    for name in os.listdir(parent):  # noqa: PTH208 - likewise
        pid = name.removeprefix(PREFIX)
        if name.startswith(PREFIX) and pid.isdigit() and not os.path.exists(f"/proc/{pid}"):  # noqa: PTH110 - likewise
            Cgroup(f"{parent}/{name}").remove(0.0)
