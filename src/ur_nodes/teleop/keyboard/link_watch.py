"""Monitor of the connection by which the keys of this terminal arrive, from a file that `link_guard` writes.

A terminal over ssh does not notice a cut connection. So a guard beside this program sends numbers to the user's
computer and gets them back; each that returns proves that the connection was there when it was sent.
"""

from __future__ import annotations

import os
import struct
import time
from collections.abc import Callable, Mapping

VARIABLE = "UR_LINK"
"""The file; not set where the terminal is of this computer."""

LINK_LIMIT = 0.15
"""Seconds after which a proof is too old to drive by."""

_PROOF = struct.Struct("d")  # s, of the steady clock of this computer


def make_watch(environment: Mapping[str, str], now: Callable[[], float] = time.monotonic) -> Callable[[], bool]:
    """Return a function that returns whether the newest proof is fresh, which is always true without a guard."""
    path = environment.get(VARIABLE, "")
    if not path:
        return lambda: True

    def is_fresh() -> bool:
        try:
            descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
        except OSError:
            return False
        try:
            data = os.read(descriptor, _PROOF.size)
        finally:
            os.close(descriptor)
        return len(data) == _PROOF.size and now() - float(_PROOF.unpack(data)[0]) <= LINK_LIMIT

    return is_fresh
