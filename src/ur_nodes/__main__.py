"""Run a node's module: python -m ur_nodes MODULE [ARG ...].

An interrupt while the module is still importing ends it without a word; rospy sets its own handler once it starts.
"""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType


def _leave(_number: int, _frame: FrameType | None) -> None:
    os._exit(128 + signal.SIGINT)


if __name__ == "__main__":
    signal.signal(signal.SIGINT, _leave)
    import runpy

    from ur_nodes.rosio.log_link import leave_log_link

    leave_log_link()
    del sys.argv[0]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
