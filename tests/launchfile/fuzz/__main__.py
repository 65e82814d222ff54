"""Fuzz the launch language for as long as you like, beside the installed roslaunch where there is one.

    .venv/bin/python -m tests.launchfile.fuzz [--minutes N] [--seed N] [--keep FOLDER]

Each round breaks a file of the corpus, loads it and renders what is found. Reported, with the file kept: an exception,
more than 5 s, and a plan that differs from roslaunch's. Files that would start programs, or compute for long, are not
given to roslaunch. Exit code 1 when something was reported.
"""

import argparse
import random
import sys
import tempfile
import time
from pathlib import Path

from tests.fuzz.mutate import mutate
from tests.launchfile.conftest import BASE_ENVIRONMENT, Reference, differences, our_plan
from tests.launchfile.fuzz.survive import WORDS, check_survives, read_corpus

_NOT_FOR_ROSLAUNCH = (
    b"command",
    b"**",
    b"<<",
    b"open",
    b"exec",
    b"range",
    b"ENTITY",
    b"DOCTYPE",
    b"factorial",
    b"/dev",
)
_SLOW = 5.0


def main() -> int:
    """Run for the given time; print what was found, and how many files it took."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=None, help="default: another one each time")
    parser.add_argument("--keep", type=Path, default=Path("fuzz_findings"), help="where files that fail are kept")
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.SystemRandom().randrange(2**32)
    sys.stdout.write(f"seed {seed}\n")
    with tempfile.TemporaryDirectory(prefix="fuzz_launchfile_") as folder:
        return _fuzz(Path(folder) / "a.launch", random.Random(seed), options.minutes * 60, options.keep)


def _fuzz(path: Path, chance: random.Random, seconds: float, keep: Path) -> int:
    corpus = read_corpus()
    reference = Reference() if Path("/usr/lib/python3/dist-packages/roslaunch").exists() else None
    end = time.monotonic() + seconds
    rounds = found = 0
    try:
        while time.monotonic() < end:
            rounds += 1
            data = mutate(corpus, WORDS, chance)
            path.write_bytes(data)
            problem = _look(path, data, reference)
            if problem:
                found += 1
                keep.mkdir(exist_ok=True)
                kept = keep / f"{found}.launch"
                kept.write_bytes(data)
                sys.stdout.write(f"{kept}: {problem}\n")
    finally:
        if reference is not None:
            reference.close()
    sys.stdout.write(f"{rounds} files, {found} findings\n")
    return 1 if found else 0


def _look(path: Path, data: bytes, reference: Reference | None) -> str | None:
    start = time.monotonic()
    try:
        check_survives(path, BASE_ENVIRONMENT)
    except Exception as problem:
        return f"{type(problem).__name__}: {problem}"
    took = time.monotonic() - start
    if took > _SLOW:
        return f"takes {took:.1f} s"
    if reference is None or any(word in data for word in _NOT_FOR_ROSLAUNCH):
        return None
    theirs = reference.load([str(path)], ["a:=1"], BASE_ENVIRONMENT)
    return "; ".join(differences(our_plan([str(path)], ["a:=1"], BASE_ENVIRONMENT), theirs)) or None


if __name__ == "__main__":
    sys.exit(main())
