"""Fuzz every parser of foreign input for as long as you like.

    .venv/bin/python -m tests.fuzz [--minutes N] [--kind KIND ...] [--seed N]

Each kind gets the same share of the time, in a process of its own. Reported are undeclared exceptions, more than 10 s
of computing or 60 s in all, and more than 200 MB of memory. An input that caused one is kept in tests/fuzz/corpus/KIND,
which the tests replay. Exit code 1 when something was found.
"""

import argparse
import hashlib
import json
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz.target import CORPUS, list_kinds

_LARGEST_KEPT = 100_000  # bytes


@dataclass(slots=True)
class Tally:
    """The figures of a kind: inputs, and finds by the place and type of the problem."""

    inputs: int = 0
    finds: dict[str, str] = field(default_factory=dict)


def main() -> int:
    """Fuzz for the given time, print a line for each kind and each find."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=30.0, help="default: %(default)g")
    parser.add_argument("--kind", action="append", choices=list_kinds(), metavar="KIND", help=", ".join(list_kinds()))
    parser.add_argument("--seed", type=int, default=None, help="default: another one each time")
    parser.add_argument("--keep", type=Path, default=CORPUS, help="folder for inputs that cause a find")
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.SystemRandom().randrange(2**32)
    kinds = options.kind or list(list_kinds())
    sys.stdout.write(f"seed {seed}, {options.minutes * 60 / len(kinds):.0f} s for each of {len(kinds)} kinds\n")
    total = Tally()
    for kind in kinds:
        tally = fuzz_kind(kind, options.minutes * 60 / len(kinds), seed, options.keep)
        sys.stdout.write(f"{kind:20} {tally.inputs:9,} inputs {len(tally.finds):3} finds\n")
        sys.stdout.flush()
        total.inputs += tally.inputs
        total.finds.update(tally.finds)
    sys.stdout.write(f"{'total':20} {total.inputs:9,} inputs {len(total.finds):3} finds\n")
    return 1 if total.finds else 0


def fuzz_kind(kind: str, seconds: float, seed: int, keep: Path) -> Tally:
    """Fuzz one kind; a worker that an input has ended is replaced by another one."""
    tally = Tally()
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        with tempfile.TemporaryDirectory(prefix="fuzz_") as scratch:
            words = [sys.executable, "-m", "tests.fuzz.worker", kind, str(left), str(seed), scratch]
            worker = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2])
            try:
                assert worker.stdout is not None
                for line in worker.stdout:
                    _take(json.loads(line), kind, tally, keep)
                code = worker.wait()
            finally:
                worker.kill()
                worker.wait()
            if code < 0:
                what = f"ended by {signal.Signals(-code).name}"
                _take({"find": what, "file": f"{scratch}/current"}, kind, tally, keep)
            elif code:
                raise SystemExit(f"the worker for {kind} failed with exit code {code}")
        seed += 1
    return tally


def _take(line: dict[str, object], kind: str, tally: Tally, keep: Path) -> None:
    tally.inputs += int(str(line.get("inputs", 0)))
    if "find" not in line:
        return
    problem, source = str(line["find"]), Path(str(line["file"]))
    key = f"{kind} {problem.partition(':')[0]} {problem.rpartition(' in ')[2]}"  # the exception's type and its place
    if key in tally.finds:
        return
    tally.finds[key] = problem
    data = source.read_bytes()
    kept = keep / kind / f"find-{hashlib.sha256(data).hexdigest()[:12]}"
    if len(data) <= _LARGEST_KEPT:
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, kept)
    sys.stdout.write(f"{kind}: {problem}\n  {kept} ({len(data):,} bytes)\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
