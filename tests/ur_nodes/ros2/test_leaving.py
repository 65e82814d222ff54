"""The end of a node whose middleware does not let it go."""

from __future__ import annotations

from tests.ros2_session import Ros2Session

STUCK = """
import ctypes
from ur_nodes.ros2.run import limit_shutdown
limit_shutdown(0.5)
print("leaving", flush=True)
ctypes.PyDLL(None).pause()  # with Python's lock held, as in the middleware
"""


def test_process_ends_though_the_middleware_waits_for_ever(session: Ros2Session) -> None:
    done = session.run("-c", STUCK, within=60.0)
    assert (done.stdout, done.stderr, done.returncode) == ("leaving\n", "", 1)
