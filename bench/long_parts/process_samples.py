"""Samples of the processes of a run, and their growth."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

_RISE = 2.0  # MB that the memory of a process may rise by over the whole of a run
_SHARE = 0.02  # or this share of its memory
_LARGEST_LOGS = 512.0 + 200.0  # MB: the bound of a run, and what rosout's own rotation keeps


@dataclass(frozen=True, slots=True)
class ProcessSample:
    """Memory in MB (10^6 bytes, proportional set size), open files, threads and MB written to disks by one process."""

    memory: float
    files: int
    threads: int
    written: float = 0.0


@dataclass(frozen=True, slots=True)
class Sample:
    """The processes of a run by name, and the size of all its log files in MB, at a time in minutes."""

    minutes: float
    processes: dict[str, ProcessSample]
    logs: float


def take_sample(pid: int, logs: Path, minutes: float) -> Sample:
    """Sample a process and all that it has started."""
    found = {}
    root = psutil.Process(pid)
    for process in (root, *root.children(recursive=True)):
        with suppress(psutil.NoSuchProcess, FileNotFoundError, ProcessLookupError):
            name = "ur launch" if process is root else _name(process)
            while name in found:
                name += "'"
            memory = process.memory_full_info().pss / 1e6
            written = process.io_counters().write_bytes / 1e6
            found[name] = ProcessSample(memory, process.num_fds(), process.num_threads(), written)
    size = sum(path.lstat().st_size for path in logs.rglob("*") if path.is_file() and not path.is_symlink())
    return Sample(minutes, found, size / 1e6)


def describe_growth(samples: Sequence[Sample], warm: float) -> tuple[list[str], list[str]]:
    """A table of each process after `warm` minutes, with its growth an hour; and what grows."""
    kept = [sample for sample in samples if sample.minutes >= warm]
    names = sorted(set.intersection(*(set(sample.processes) for sample in kept)))
    titles = "".join(f"{title:>12}" for title in ("kB written", "files", "threads"))
    lines = [f"  {'from minute ' + format(kept[0].minutes, 'g'):<24}{'MB':>8}{'MB/h':>8}{titles}"]
    growing = []
    for name in names:
        each = [sample.processes[name] for sample in kept]
        slope = fit_slope([sample.minutes / 60.0 for sample in kept], [process.memory for process in each])
        rise = slope * (kept[-1].minutes - kept[0].minutes) / 60.0
        first, last = each[0], each[-1]
        files, threads = f"{first.files} -> {last.files}", f"{first.threads} -> {last.threads}"
        written = f"{1e3 * (last.written - first.written):.0f}"
        lines.append(f"  {name:<24}{last.memory:8.1f}{slope:8.2f}{written:>12}{files:>12}{threads:>12}")
        if rise > max(_RISE, _SHARE * first.memory):
            growing.append(f"memory of {name}")
        if has_risen([process.files for process in each]):
            growing.append(f"open files of {name}")
        if has_risen([process.threads for process in each]):
            growing.append(f"threads of {name}")
    logs = fit_slope([sample.minutes / 60.0 for sample in kept], [sample.logs for sample in kept])
    lines.append(f"  {'log files':<24}{kept[-1].logs:8.1f}{logs:8.2f}")
    if kept[-1].logs > _LARGEST_LOGS:
        growing.append("log files, above their bound")
    gone = sorted({name for sample in kept for name in sample.processes} - set(names))
    lines += [f"  not all the time: {', '.join(gone)}"] if gone else []
    return lines, growing


def fit_slope(places: Sequence[float], values: Sequence[float]) -> float:
    """Slope of the least squares line; 0 for fewer than two different places."""
    mean_x, mean_y = sum(places) / len(places), sum(values) / len(values)
    spread = sum((x - mean_x) ** 2 for x in places)
    return sum((x - mean_x) * (y - mean_y) for x, y in zip(places, values, strict=True)) / spread if spread else 0.0


def has_risen(counts: Sequence[int]) -> bool:
    """Test whether every count of the last third, at least two, is above every one of the first."""
    third = max(2, len(counts) // 3)
    return len(counts) >= 2 * third and min(counts[-third:]) > max(counts[:third])


def _name(process: psutil.Process) -> str:
    command = process.cmdline()
    for word in command:
        if word.startswith("__name:="):
            return word.partition(":=")[2]
    return next((Path(word).name for word in command if word.endswith("rosmaster")), process.name())
