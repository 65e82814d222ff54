"""Clients that drive and show a robot, shared by the terminal, the page and users' programs.

Users' programs begin with `from ur_nodes.client import Robot`. In the other modules reads return frozen values and may
come from any thread; requests are made on the node's thread, unless their docstrings allow any thread.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ur_nodes.client.script.node_calls import Interrupted, Lost, Refused, RobotError, TakenOver
    from ur_nodes.client.script.robot import Robot

__all__ = ["Interrupted", "Lost", "Refused", "Robot", "RobotError", "TakenOver"]


def __getattr__(name: str) -> object:
    """Load the public names when they are used: nodes that need one module of the package need no more."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.script.{'robot' if name == 'Robot' else 'node_calls'}"), name)
