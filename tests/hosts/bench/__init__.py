"""The test bench of several computers: booted containers on a network of their own, on this one."""

from tests.hosts.bench.bench import REPOSITORY, Bench, boot
from tests.hosts.bench.machine import Done, Machine, wait_until
from tests.hosts.bench.root import find_obstacle

UR = f"{REPOSITORY}/.venv/bin/python -I -m ur"

__all__ = ["REPOSITORY", "UR", "Bench", "Done", "Machine", "boot", "find_obstacle", "wait_until"]
