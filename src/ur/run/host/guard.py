"""Start of the guard, the parent process of the host: it forks the host, then executes `guard.sh`."""

from __future__ import annotations

import os

from ur.run.host.cgroup import make_cgroup
from ur.run.host.descendants import inherit_orphans
from ur.run.host.signals import IGNORED, signal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

SCRIPT = os.path.join(os.path.dirname(__file__), "guard.sh")  # noqa: PTH118, PTH120 - pathlib doubles the start-up time
ALL_ENDED = b"ended\n"  # what guard.sh expects of a host that has left nothing behind


def run_guarded(descriptor: int) -> NoReturn:
    """Fork the process host, which serves the supervisor behind a socket, and guard it."""
    inherit_orphans()  # the shell that replaces this process does that
    cgroup = make_cgroup(os.getpid())
    reader, writer = os.pipe2(os.O_CLOEXEC)
    host = os.fork()
    if host == 0:
        from ur.run.host.server import serve  # unused by the guard

        try:
            serve(descriptor)
            os.write(writer, ALL_ENDED)
        finally:
            os._exit(0)
    if cgroup is not None:
        cgroup.add(host)  # s for its start, which may take as long
    for signum in IGNORED:
        signal.signal(signum, signal.SIG_IGN)
    os.close(descriptor)
    os.dup2(reader, 0)
    os.execv("/bin/sh", ["ur-guard", SCRIPT, "" if cgroup is None else cgroup.path])  # noqa: S606 - see above
