"""Many robots: set-up, `ur doctor` and `ur boot status` of booted containers, with one command for all of them.

Needs root, as `bench/setup` does; each size takes minutes. All containers share this computer, so that the time of a
set-up is mostly theirs; the costs of the others are the laptop's processor time, of the command and all that it starts.
The peer of these asks one robot after the other.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence

from bench.scale_parts.rows import Row
from tests.hosts.bench import UR, Machine, boot, find_obstacle
from tests.hosts.test_robot_setup import PASSWORD, TRUSTING, prepare

SIZES = (1, 2, 3, 4)
SIZE = "robots"
PEER = "one command after the other"
_TICKS = os.sysconf("SC_CLK_TCK")
# The processor time of what a shell has waited for, in s: user and system, its own children and theirs.
_MEASURE = "{{ {line}; }} >/dev/null 2>&1; code=$?; awk '{{ print $16, $17 }}' /proc/$$/stat; exit $code"


def measure(sizes: Sequence[int]) -> Iterator[Row]:
    """Rows for these numbers of freshly flashed robots. Raises SystemExit where none can be booted."""
    obstacle = find_obstacle()
    if obstacle:
        raise SystemExit(f"no computers to measure with: {obstacle}")
    for size in sizes:
        names = [f"r{number}" for number in range(1, size + 1)]
        with boot(("laptop", *names)) as bench:
            prepare(bench["laptop"])
            began = time.monotonic()
            processor = _set_up(bench["laptop"], names)
            yield Row("robots: set-up, elapsed", size, time.monotonic() - began, "s")
            yield Row("robots: set-up, laptop", size, processor, "s")
            yield from _rows(bench["laptop"], names)


def _set_up(laptop: Machine, names: Sequence[str]) -> float:
    """Set the robots up; the processor time on the laptop in s. Raises AssertionError when that fails."""
    robots = "".join(f"- {{host: {name}.local, name: {name}, base: magni}}\n" for name in names)
    laptop.write("/home/pat/robots.yaml", f"robots:\n{robots}")
    line = f"{UR} robot setup --from robots.yaml --no-programs --passwords-from 0 {' '.join(TRUSTING)}"
    done = laptop.run(_MEASURE.format(line=line), user="pat", stdin=f"ros\n{PASSWORD}\n", timeout=1800).check()
    return sum(map(int, done.out.split())) / _TICKS


def _rows(laptop: Machine, names: Sequence[str]) -> Iterator[Row]:
    for title, one, several in (
        ("boot status", "boot status --robot {}", " ".join(f"--robot {name}" for name in names)),
        ("doctor", "doctor {}", " ".join(names)),
    ):
        verb = one.partition(" {}")[0].removesuffix(" --robot")
        cost = _measure(laptop, f"{UR} {verb} {several}")
        peer = _measure(laptop, "; ".join(f"{UR} {one.format(name)}" for name in names))
        yield Row(f"robots: {title}", len(names), cost, "s", peer)


def _measure(laptop: Machine, line: str) -> float:
    """The processor time of a command line on the laptop, in s."""
    done = laptop.run(_MEASURE.format(line=line), user="pat", timeout=600)
    return sum(map(int, done.out.split())) / _TICKS
