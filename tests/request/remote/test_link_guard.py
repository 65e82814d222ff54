"""The guard of a connection: proofs while numbers come back, none from before a cut."""

import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from ur.request.remote import link_guard
from ur_nodes.teleop.keyboard.teleop_twist_keyboard_node import LINK_LIMIT, make_watch


class Guard:
    """The program, and this computer's end of its connection."""

    def __init__(self, path: Path) -> None:
        self.path = path
        command = [sys.executable, "-I", link_guard.__file__, str(path)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def read(self) -> bytes:
        assert self.process.stdout
        return self.process.stdout.readline()

    def send(self, data: bytes) -> None:
        assert self.process.stdin
        self.process.stdin.write(data)
        self.process.stdin.flush()

    def proof(self) -> float:
        """The newest proof; 0.0 before the first."""
        data = self.path.read_bytes()
        return float(struct.unpack("d", data)[0]) if data else 0.0

    def wait_for_proof(self, after: float = 0.0) -> float:
        end = time.monotonic() + 10.0
        while (found := self.proof()) <= after:
            assert time.monotonic() < end
        return found


@pytest.fixture
def guard(tmp_path: Path) -> Iterator[Guard]:
    made = Guard(tmp_path / "link")
    yield made
    made.process.kill()
    made.process.communicate()


def test_number_that_returns_proves_the_time_when_it_was_sent(guard: Guard) -> None:
    first = guard.read()
    before = time.monotonic()
    guard.send(first)
    assert guard.wait_for_proof() <= before


def test_numbers_that_a_cut_has_held_back_prove_nothing_new(guard: Guard) -> None:
    held = [guard.read() for _ in range(5)]
    latest = guard.read()
    guard.send(latest)
    proof = guard.wait_for_proof()
    guard.send(b"".join(held) + latest + b"999999\nnonsense\n")
    guard.send(guard.read())
    assert guard.wait_for_proof(proof) > proof


def test_file_of_proofs_ends_with_the_connection(guard: Guard) -> None:
    guard.read()
    assert guard.path.exists()
    assert guard.path.stat().st_mode & 0o777 == 0o600
    guard.process.communicate(timeout=10)
    assert not guard.path.exists()


def test_proof_is_fresh_for_a_moment_only(tmp_path: Path) -> None:
    path, now = tmp_path / "link", [5.0]
    fresh = make_watch({"UR_LINK": str(path)}, lambda: now[0])
    assert not fresh()
    path.write_bytes(struct.pack("d", 5.0))
    assert fresh()
    now[0] += LINK_LIMIT + 0.01
    assert not fresh()
    path.write_bytes(b"short")
    assert not fresh()


def test_terminal_of_this_computer_needs_no_proof() -> None:
    assert make_watch({})()
