"""One process that feeds one parser: `python -m tests.fuzz.worker KIND SECONDS SEED SCRATCH`, or `KIND replay`.

Each input is written to SCRATCH/current before the parser gets it, so that one that ends the process is not lost. The
limits of an input are 10 s of computing, 60 s in all, and 200 MB of memory for the whole process. Lines of JSON on
standard output are finds; the last line holds the number of inputs.
"""

import hashlib
import json
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path
from types import FrameType
from typing import Any

from tests.fuzz.mutate import mutate
from tests.fuzz.target import CORPUS, Target, load_target

CPU_SECONDS = 10
WALL_SECONDS = 60
MEMORY = 200 << 20
_HARD_MEMORY = 2 << 30
_SLICE = 5000  # inputs between two reports


class OverLimitError(BaseException):
    """An input takes longer than it may. No parser catches it."""


def check_input(target: Target, data: bytes, folder: Path, memory: int = MEMORY) -> str | None:
    """Give an input to a parser; the description of what is wrong, without the input, or None."""
    folder.mkdir(exist_ok=True)
    _set_alarms(CPU_SECONDS, WALL_SECONDS)
    try:
        target.run(data, folder)
    except OverLimitError as problem:
        return f"{problem} {_find_place(problem)}"
    except (Exception, SystemExit) as problem:
        return f"{type(problem).__name__}: {str(problem)[:200]!r} {_find_place(problem)}"
    finally:
        _set_alarms(0, 0)
        shutil.rmtree(folder, ignore_errors=True)
    used = read_peak_memory()
    return f"takes {used >> 20} MB" if used > memory else None


def read_peak_memory() -> int:
    """The largest resident size of this process, in bytes."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return int(status.partition("VmHWM:")[2].split()[0]) << 10


def guard_process() -> None:
    """Set the limits that hold whatever the parser does: memory, and signals when an input takes too long."""
    signal.signal(signal.SIGPROF, _stop_computing)
    signal.signal(signal.SIGALRM, _stop_waiting)
    resource.setrlimit(resource.RLIMIT_AS, (_HARD_MEMORY, _HARD_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _set_alarms(computing: float, waiting: float) -> None:
    signal.setitimer(signal.ITIMER_PROF, computing)
    signal.setitimer(signal.ITIMER_REAL, waiting)
    # Code that never returns to Python sees no handler; this limit ends the process.
    end = int(time.process_time()) + int(computing) + 5 if computing else resource.RLIM_INFINITY
    resource.setrlimit(resource.RLIMIT_CPU, (end, resource.RLIM_INFINITY))


def _stop_computing(_: int, __: FrameType | None) -> None:
    raise OverLimitError(f"computes for more than {CPU_SECONDS} s")


def _stop_waiting(_: int, __: FrameType | None) -> None:
    raise OverLimitError(f"waits for more than {WALL_SECONDS} s")


def _find_place(problem: BaseException) -> str:
    frames = [
        frame for frame in traceback.extract_tb(problem.__traceback__) if "/tests/fuzz/worker" not in frame.filename
    ]
    own = [frame for frame in frames if "/src/ur" in frame.filename] or frames
    return f"in {own[-1].filename.rpartition('/src/')[2]}:{own[-1].lineno}" if own else ""


def _report(**fields: Any) -> None:
    sys.stdout.write(json.dumps(fields) + "\n")
    sys.stdout.flush()


def _fuzz(target: Target, seconds: float, seed: int, scratch: Path) -> None:
    chance = random.Random(seed)
    inputs = target.read_inputs()
    current = scratch / "current"
    end = time.monotonic() + seconds
    count = reported = 0
    while time.monotonic() < end:
        data = mutate(inputs, target.words, chance)
        current.write_bytes(data)
        count += 1
        problem = check_input(target, data, scratch / "folder")
        if count - reported >= _SLICE:
            _report(inputs=count - reported)
            reported = count
        if problem:
            kept = scratch / hashlib.sha256(data).hexdigest()[:12]
            kept.write_bytes(data)
            _report(find=problem, file=str(kept))
            if problem.startswith("takes"):
                break  # the peak stays, so that another process has to go on
    _report(inputs=count - reported)


def replay(target: Target) -> int:
    """Give a parser the corpus once; the number of finds, which are printed."""
    finds = 0
    files = [path for path in sorted((CORPUS / target.kind).glob("*")) if path.is_file()]
    with tempfile.TemporaryDirectory(prefix="fuzz_replay_") as scratch:
        for path in files:
            if problem := check_input(target, path.read_bytes(), Path(scratch) / "folder"):
                finds += 1
                _report(find=problem, file=str(path))
                if problem.startswith("takes"):
                    break  # the peak stays
    _report(inputs=len(files))
    return finds


def main(words: list[str]) -> int:
    """Run as the first lines of this file say."""
    target = load_target(words[0])
    guard_process()
    if words[1] == "replay":
        return 1 if replay(target) else 0
    _fuzz(target, float(words[1]), int(words[2]), Path(words[3]))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
