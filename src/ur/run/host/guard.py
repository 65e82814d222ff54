"""The guard: the process above the host, which ends what is left when the host cannot any more."""

from __future__ import annotations

import os
import signal

from ur.run.host.cgroup import Cgroup, make_cgroup
from ur.run.host.family import IGNORED, inherit_orphans, kill_descendants, name_process

LIMIT = 3.0  # s that processes get to die of SIGKILL; one that does not hangs in the kernel


def run_guarded(descriptor: int) -> None:
    """Fork the process host, which serves the supervisor behind a socket; when it has ended, end what it left."""
    inherit_orphans()
    cgroup = make_cgroup(os.getpid())
    host = os.fork()
    if host == 0:
        if cgroup is not None:
            cgroup.enter()
        from ur.run.host.server import serve  # the guard needs none of it

        serve(descriptor)
        os._exit(0)
    os.close(descriptor)
    name_process(b"ur-guard")
    for signum in IGNORED:
        signal.signal(signum, signal.SIG_IGN)
    _await_end(host)
    _end_rest(cgroup)


def _await_end(pid: int) -> None:
    while os.waitpid(-1, 0)[0] != pid:
        pass


def _end_rest(cgroup: Cgroup | None) -> None:
    if cgroup is not None:
        cgroup.kill()
    kill_descendants(LIMIT)
    if cgroup is not None:
        cgroup.remove(LIMIT)
