import subprocess
import sys

# In a process of its own: whoever starts a host inherits orphans from then on.
BURST = """
import os
from ur.run.process.host_client import start_host
from ur.run.supervisor.events import Exited, Started, StartFailed
host = start_host()
null = os.open(os.devnull, os.O_RDWR)
host.begin({"PATH": "/usr/bin:/bin"}, keep_terminal=False)
for number in range(400):  # twice what a socket takes in answers that nobody reads
    program = "/bin/true" if number % 100 else "/bin/nothing"
    host.start_process(str(number), [program], "/", {}, (null, null, null), "group")
found = [host.receive() for _ in range(800)]
for kind in (Started, Exited, StartFailed):
    print(sum(isinstance(event, kind) for event in found))
host.close()
"""


def test_burst_of_starts_whose_answers_are_read_late_does_not_block() -> None:
    done = subprocess.run([sys.executable, "-c", BURST], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.split() == ["400", "396", "4"]
