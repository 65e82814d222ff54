"""`run_foreground` for programs that still use rospy."""

from __future__ import annotations

import threading
from collections.abc import Callable

from ur_nodes.run import run_foreground


def run_in_foreground(name: str, body: Callable[[threading.Event], int]) -> int:
    """See `ur_nodes.run.run_foreground`; `body` makes its own subscriptions."""
    return run_foreground(name, lambda _node: None, lambda _wired, ended: body(ended))
