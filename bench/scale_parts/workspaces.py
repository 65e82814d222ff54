"""Large workspaces: `ur check`, `ur find`, `ur graph`, `ur docs` and Tab over launch files that include one another."""

import os
import statistics
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from bench.scale_parts.rows import Row, Usage, measure_command
from bench.scale_parts.workspace_files import FILES_EACH, change_one_file, make_workspace

SIZES = (100, 300, 1000, 3000)
SIZE = "launch files"
PEER = "roslaunch-check"
_THEIRS = "/usr/share/roslaunch/scripts/roslaunch-check"
_THEIR_CHECK = """
import runpy, sys
script, folder = sys.argv[1:]
print(runpy.run_path(script)["check_roslaunch_dir"](folder))
"""  # as the script does with a folder, which must lie in a package for it
_LARGEST_FOR_PEER = 300  # it takes minutes beyond
_TABS = 5


def measure(sizes: Sequence[int]) -> Iterator[Row]:
    """Rows for each command in a workspace of `size` launch files and 1,000 packages, or more where they need more.

    Costs are processor time of the whole command, and its largest memory. Caches lie in a folder of the workspace.
    """
    for size in sizes:
        with tempfile.TemporaryDirectory() as folder:
            yield from _measure(size, Path(folder))


def _measure(size: int, folder: Path) -> Iterator[Row]:
    source = folder / "src"
    make_workspace(source, size, packages=max(1000, size // FILES_EACH))
    environment = {
        **os.environ,
        "ROS_PACKAGE_PATH": str(source),
        "HOME": str(folder / "home"),
        "XDG_CACHE_HOME": str(folder / "cache"),
    }
    first = _ours(["check", str(source)], environment)
    peer = _peer(source, environment) if size <= _LARGEST_FOR_PEER else None
    yield Row("ur check", size, first.processor, "s", peer)
    yield Row("ur check", size, first.memory, "MB")
    change_one_file(source)
    again = _ours(["check", str(source)], environment)
    yield Row("ur check, after one edit", size, again.processor, "s")
    yield Row("ur check, after one edit", size, again.memory, "MB")
    yield Row("ur find", size, _ours(["find", "scan_1", str(source), "--kind", "topic"], environment).processor, "s")
    documents = _ours(["docs", str(source), "--output", "-"], environment)
    yield Row("ur docs", size, documents.processor, "s")
    yield Row("ur docs", size, documents.memory, "MB")
    for form in ("text", "svg"):
        drawn = _ours(["graph", str(folder / "all.launch"), "--as", form], environment)
        yield Row(f"ur graph --as {form}", size, drawn.processor, "s")
    tabs = [_ours(["__complete", "bash", "ur launch pac"], environment) for _ in range(_TABS)]
    yield Row("Tab", size, statistics.median(tab.processor for tab in tabs), "s")


def _ours(words: list[str], environment: Mapping[str, str]) -> Usage:
    usage = measure_command([sys.executable, "-I", "-m", "ur", *words], environment)
    if usage.code not in (0, 1):  # 1: something is found
        raise RuntimeError(f"ur {' '.join(words)} ended with {usage.code}")
    return usage


def _peer(source: Path, environment: Mapping[str, str]) -> float | None:
    if not Path(_THEIRS).exists():
        return None
    return measure_command(["/usr/bin/python3", "-c", _THEIR_CHECK, _THEIRS, str(source)], environment).processor
