import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from ur.run.host.cgroup import Cgroup, find_cgroup, find_folder, make_cgroup

HYBRID = (
    "30 24 0:27 / /sys/fs/cgroup/unified rw,nosuid shared:10 - cgroup2 cgroup2 rw,nsdelegate\n"
    "31 24 0:28 / /sys/fs/cgroup/cpu rw,nosuid shared:11 - cgroup cgroup rw,cpu\n"
)
UNIFIED = "29 23 0:26 / /sys/fs/cgroup rw,nosuid,nodev,noexec,relatime shared:4 - cgroup2 cgroup2 rw\n"
INSIDE = "29 23 0:26 /machine/box /sys/fs/cgroup rw - cgroup2 cgroup2 rw\n"


@pytest.mark.parametrize(
    ("own", "mounts", "folder"),
    [
        ("0::/user.slice/a.scope\n", UNIFIED, "/sys/fs/cgroup/user.slice/a.scope"),
        ("4:cpu:/x\n0::/b.scope\n", HYBRID, "/sys/fs/cgroup/unified/b.scope"),
        ("0::/\n", HYBRID, "/sys/fs/cgroup/unified"),
        ("0::/machine/box/run.scope\n", INSIDE, "/sys/fs/cgroup/run.scope"),
        ("0::/elsewhere\n", INSIDE, None),
        ("4:cpu:/x\n", HYBRID, None),
        ("0::/a\n", "", None),
    ],
)
def test_folder_of_a_cgroup_follows_the_mount(own: str, mounts: str, folder: str | None) -> None:
    assert find_folder(own, mounts) == folder


@pytest.fixture
def cgroup() -> Iterator[Cgroup]:
    """A real one, where one may be made."""
    made = make_cgroup(os.getpid())
    if made is None:
        pytest.skip("no cgroup (v2) can be made here")
    yield made
    made.kill()
    assert made.remove(60)


def start_inside(cgroup: Cgroup) -> int:
    """A process of the group that ignores what it can, with a child in a session of its own."""
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        try:
            cgroup.add(os.getpid())
            for signum in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(signum, signal.SIG_IGN)
            if os.fork() == 0:
                os.setsid()
            os.write(writer, b"x")
            time.sleep(600)
        finally:
            os._exit(1)
    os.close(writer)
    for _ in range(2):
        os.read(reader, 1)
    os.close(reader)
    return pid


def test_kill_reaches_every_process_that_was_born_inside(cgroup: Cgroup) -> None:
    pid = start_inside(cgroup)
    if not cgroup.list_processes():
        os.kill(pid, signal.SIGKILL)
        pytest.skip("processes may not be moved here")
    assert len(cgroup.list_processes()) == 2
    assert not cgroup.remove(0.0)
    cgroup.kill()
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == -signal.SIGKILL
    assert cgroup.remove(60)


def test_empty_group_of_a_guard_that_was_killed_is_removed_by_the_next(cgroup: Cgroup) -> None:
    stale = Path(cgroup.path).with_name("ur-4194305")  # beyond the largest process id, proc(5)
    stale.mkdir()
    found = find_cgroup(os.getpid())
    assert found is not None
    assert found.path == cgroup.path
    cgroup.remove(0.0)
    assert make_cgroup(os.getpid()) is not None
    assert not stale.exists()


def test_group_that_cannot_be_made_is_none(cgroup: Cgroup) -> None:
    assert make_cgroup(os.getpid()) is None  # it is there already
    assert cgroup.list_processes() == []
