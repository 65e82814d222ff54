"""CPU and memory of processes, read from /proc (proc(5)) without starting a process."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

_TICK = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True, slots=True)
class Usage:
    """Usage of a process and its descendants: `cpu` in s since they started, `memory` (resident) in bytes."""

    cpu: float
    memory: int


def read_usage(pids: Mapping[str, int]) -> dict[str, Usage]:
    """Return the usage of each process tree, by the name of its root. A tree that has ended is left out."""
    children: dict[int, list[int]] = {}
    own: dict[int, tuple[int, int]] = {}
    for pid, parent, ticks, pages in _read_processes():
        children.setdefault(parent, []).append(pid)
        own[pid] = (ticks, pages)
    found = {}
    for name, root in pids.items():
        if root not in own:
            continue
        ticks = pages = 0
        queue = [root]
        while queue:
            pid = queue.pop()
            ticks += own[pid][0]
            pages += own[pid][1]
            queue += children.get(pid, ())
        found[name] = Usage(ticks / _TICK, pages * _PAGE)
    return found


def _read_processes() -> Iterator[tuple[int, int, int, int]]:
    for entry in os.listdir("/proc"):  # noqa: PTH208 - pathlib is not worth its import here
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", "rb") as file:  # noqa: PTH123 - likewise
                words = file.read().rpartition(b")")[2].split()
        except OSError:
            continue
        yield int(entry), int(words[1]), int(words[11]) + int(words[12]), int(words[21])
