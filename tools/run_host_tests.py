"""Run the tests on booted computers, one file at a time, and print a table: tests/hosts/run [OPTION ...] [FILE ...].

    tests/hosts/run                               # all files that have not passed on this commit and tree
    tests/hosts/run --again                       # all files
    tests/hosts/run tests/hosts/test_mount.py     # one file; other arguments go to pytest

Each file has a pytest process of its own, so that a crash ends one file. A file that passed is remembered for the
commit and the uncommitted changes it passed with, in $XDG_CACHE_HOME/ur-hosts or /var/cache/ur-hosts, and is left out
next time. Ctrl-C ends the running file, removes its computers and prints the table of what ran. Needs root.
"""

import hashlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.hosts.bench.ledger import remove_stale  # noqa: E402 - needs the path above
from tests.hosts.bench.root import cache_folder, find_obstacle  # noqa: E402

KEPT_FOR = 14 * 24 * 3600.0  # seconds for which the results of a commit are remembered
NAMED_FAILURES = 40
ENDED = (0, 1, 5)  # pytest's exit codes for: passed, some failed, no test selected


@dataclass(frozen=True, slots=True)
class Result:
    """The outcome of one file: numbers of tests, seconds, names of failed tests, and why the process ended early."""

    file: str
    passed: int
    failed: int
    skipped: int
    seconds: float
    failures: tuple[str, ...] = ()
    trouble: str = ""

    @property
    def green(self) -> bool:
        """True if nothing failed and the process ended by itself."""
        return not self.failed and not self.trouble


def main(argv: Sequence[str]) -> int:
    """Run what is asked for. Returns 0 if everything passed, 1 if something failed, 2 if nothing could run."""
    options = list(argv)
    if {"-h", "--help"} & set(options):
        print(__doc__)
        return 0
    again = "--again" in options
    options = [_find_file(name) or name for name in options if name != "--again"]
    files = [name for name in options if _find_file(name)]
    options = [name for name in options if name not in files]
    if unknown := [name for name in options if name.partition("::")[0].endswith(".py")]:
        print(f'error: no test file "{unknown[0]}", expected one of tests/hosts/test_*.py', file=sys.stderr)
        return 2
    files = files or [str(path.relative_to(ROOT)) for path in sorted((ROOT / "tests/hosts").glob("test_*.py"))]
    boots = any(Path(name).resolve().is_relative_to(ROOT / "tests/hosts") for name in files)
    if boots and (obstacle := find_obstacle()):
        print(f"error: no computers to test with: {obstacle}", file=sys.stderr)
        return 2
    state = _state_path()
    earlier = {} if again else _read(state)
    results: list[Result] = []
    kept: set[str] = set()
    interrupted = False
    for file in files:
        key = " ".join([file, *options])
        if key in earlier:
            results.append(earlier[key])
            kept.add(file)
            continue
        print(f"\n== {file}", flush=True)
        result, interrupted = run_file(file, options)
        if interrupted:
            break
        results.append(result)
        if result.green and result.passed:
            _write(state, _read(state) | {key: result})
    print(make_table(results, kept, left=len(files) - len(results)))
    if interrupted:
        return 130
    return 0 if all(result.green for result in results) else 1


def _find_file(name: str) -> str:
    """Find the test file, with its ::test, that a word names by its path or by its name in tests/hosts; "" if none."""
    path = name.partition("::")[0]
    if name.startswith("-") or not path:
        return ""
    if Path(path).exists():
        return name
    return f"tests/hosts/{name}" if Path("tests/hosts", path).is_file() else ""


def run_file(file: str, options: Sequence[str]) -> tuple[Result, bool]:
    """Run one file with pytest and remove what it left behind. The second value is true if a signal ended it."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder, "report.xml")
        pytest = [sys.executable, "-m", "pytest", file, "-m", "hosts", f"--junitxml={report}", *options]
        begin = time.monotonic()
        # A process group of its own: Ctrl-C reaches it once, from here, however often it is pressed.
        process = subprocess.Popen(pytest, cwd=ROOT, stdin=subprocess.DEVNULL, start_new_session=True)
        code, interrupted = _wait(process)
        seconds = time.monotonic() - begin
        if os.geteuid() == 0:
            remove_stale()
        trouble = "" if code in ENDED else f"pytest ended with {_name_code(code)}"
        return read_report(report, file, seconds, trouble), interrupted


def read_report(report: Path, file: str, seconds: float, trouble: str) -> Result:
    """Read pytest's JUnit report of one file; a report that is missing counts as trouble."""
    try:
        cases = list(ElementTree.parse(report).iter("testcase"))  # noqa: S314 - from our own pytest
    except (OSError, ElementTree.ParseError):
        return Result(file, 0, 0, 0, seconds, (), trouble or "pytest wrote no report")
    failed: dict[str, None] = {}
    skipped: set[str] = set()
    for case in cases:
        name = case.get("name", "")
        if case.find("failure") is not None or case.find("error") is not None:
            failed[name] = None
        elif case.find("skipped") is not None:
            skipped.add(name)
    names = {case.get("name", "") for case in cases}
    return Result(file, len(names - skipped - set(failed)), len(failed), len(skipped), seconds, tuple(failed), trouble)


def make_table(results: Sequence[Result], kept: Iterable[str], left: int = 0) -> str:
    """Lay out the results: a line a file, the failed tests by name, and a closing line with the sums."""
    remembered = set(kept)
    width = max([len("file"), *(len(result.file) for result in results)])
    lines = ["", f"{'file':<{width}}  tests  passed  failed  skipped  seconds"]
    for result in results:
        tests = result.passed + result.failed + result.skipped
        row = f"{result.file:<{width}}  {tests:5}  {result.passed:6}  {result.failed:6}  {result.skipped:7}"
        note = "  passed earlier" if result.file in remembered else f"  {result.trouble}" if result.trouble else ""
        lines.append(f"{row}  {result.seconds:7.0f}{note}")
    failures = [f"failed: {result.file}::{name}" for result in results for name in result.failures]
    lines += ["", *failures[:NAMED_FAILURES]]
    if left:
        lines.append(f"not run: {left} {'file' if left == 1 else 'files'}")
    # A file whose process died counts as a failure even where its report names none.
    died = sum(1 for result in results if not result.green and not result.failed)
    failed = sum(result.failed for result in results) + died
    passed, skipped = (sum(getattr(result, name) for result in results) for name in ("passed", "skipped"))
    return "\n".join([*lines, f"{passed} passed, {failed} failed, {skipped} skipped"])


def identify_tree() -> str:
    """Make a key from the commit, the uncommitted changes and the files that git does not know yet."""
    digest = hashlib.sha256(_git("rev-parse", "HEAD") + _git("diff", "HEAD", "--binary"))
    for name in sorted(_git("ls-files", "--others", "--exclude-standard", "-z").split(b"\0")):
        path = ROOT / os.fsdecode(name)
        if path.is_file():
            digest.update(name + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def _wait(process: subprocess.Popen[bytes]) -> tuple[int, bool]:
    """Wait for a process, and pass the first signal that should end this one on to it."""
    caught: list[int] = []

    def forward(number: int, _: object) -> None:
        if not caught:
            print("\nending the running file and its computers ...", flush=True)
            with suppress(ProcessLookupError):
                process.send_signal(number)
        caught.append(number)

    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.signal(number, forward) for number in numbers}
    try:
        return process.wait(), bool(caught)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _name_code(code: int) -> str:
    return f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"


def _git(*arguments: str) -> bytes:
    return subprocess.run(["git", "-C", str(ROOT), *arguments], check=True, capture_output=True).stdout


def _state_path() -> Path:
    """The file for this commit and tree; those of old ones are removed."""
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.glob("passed-*.json"):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > KEPT_FOR:
                path.unlink()
    return folder / f"passed-{identify_tree()}.json"


def _read(path: Path) -> dict[str, Result]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        return {key: Result(**value | {"failures": ()}) for key, value in found.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}  # nothing passed yet, or the file was damaged: run the tests


def _write(path: Path, results: dict[str, Result]) -> None:
    unfinished = path.with_suffix(f".{os.getpid()}")
    unfinished.write_text(json.dumps({key: asdict(value) for key, value in results.items()}), encoding="utf-8")
    unfinished.replace(path)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
