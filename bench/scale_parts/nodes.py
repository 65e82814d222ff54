"""Many nodes: `ur launch` to the last process and the last registered node, its memory, and the end."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from typing import Any

from bench.scale_parts.rows import Row

SIZES = (10, 50, 100, 200)
SIZE = "nodes"
PEER = "roslaunch"
_FIGURES = (
    ("started", "nodes: to the last process", "s"),
    ("registered", "nodes: to the last that the master knows", "s"),
    ("stop", "nodes: to the end of all", "s"),
    ("memory", "nodes: memory of the launcher", "MB"),
)
_LARGEST_FOR_PEER = 100
_MASTER_WITHIN = 30.0  # s


def measure(sizes: Sequence[int]) -> Iterator[Row]:
    """Rows for nodes of topic_tools' `relay` at a master that runs already, in wall time; see bench/run."""
    run = _load_run()
    with tempfile.TemporaryDirectory() as name:
        place = run.make_place(Path(name))
        master = subprocess.Popen(
            ["/usr/bin/rosmaster", "--core", "-p", str(place.port)],
            env=place.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        try:
            _wait_for_master(place)
            run.measure(place, run.rivals(place, place.write(1), 1)["ur launch"], 1)  # bytecode and caches are warm
            for size in sizes:
                commands = run.rivals(place, place.write(size), size)
                ours = run.measure(place, commands["ur launch"], size)
                theirs = run.measure(place, commands["roslaunch"], size) if size <= _LARGEST_FOR_PEER else None
                for figure, subject, unit in _FIGURES:
                    yield Row(subject, size, getattr(ours, figure), unit, theirs and getattr(theirs, figure))
        finally:
            master.terminate()
            master.wait()


def _load_run() -> Any:
    path = Path(__file__).resolve().parents[1] / "run"
    loader = SourceFileLoader("bench_run", str(path))
    spec = spec_from_loader("bench_run", loader)
    assert spec is not None
    module = module_from_spec(spec)
    sys.modules["bench_run"] = module  # dataclasses look there for their own module
    loader.exec_module(module)
    return module


def _wait_for_master(place: Any) -> None:
    end = time.monotonic() + _MASTER_WITHIN
    while subprocess.run(["/usr/bin/rosnode", "list"], env=place.environment, capture_output=True).returncode:
        if time.monotonic() > end:
            raise RuntimeError(f"no master answers within {_MASTER_WITHIN:g} s")
        time.sleep(0.2)
