import subprocess
import sys

import pytest

_USE = """
import sys, threading
import numpy as np
from pathlib import Path
from ur_nodes.memory_use import return_large_arrays

if sys.argv[1] == "returned":
    return_large_arrays()

def use():
    for size in (30_000_000, 16_000_000, 16_000_000):
        array = np.ones(size, np.uint8)
        kept.append(array[:1000].copy())
        del array

kept = []
resident = lambda: int(Path("/proc/self/statm").read_text().split()[1]) * 4096
before = resident()
worker = threading.Thread(target=use)
worker.start()
worker.join()
print(resident() - before)
"""


@pytest.mark.parametrize(("what", "returned"), [("returned", True), ("kept", False)])
def test_large_arrays_are_returned_to_the_system(what: str, returned: bool) -> None:
    done = subprocess.run([sys.executable, "-c", _USE, what], capture_output=True, text=True, check=True, timeout=60)
    assert (int(done.stdout) < 5_000_000) == returned
