"""Parameters that are set while a node of ROS 1 runs, with dynamic_reconfigure.

Each folder of parameters has a server, by which `dynparam` and `rqt_reconfigure` know the nodes of upstream.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import SimpleNamespace

import rospy

from ur_nodes.ports.parameters import Declaration, Parameters

Change = Callable[[dict[str, object]], str]
Config = dict[str, object]

_KINDS: dict[type, str] = {bool: "bool", int: "int", float: "double"}
_UNUSED: dict[str, object] = {"level": 0, "edit_method": ""}


def serve_changes(parameters: Parameters, change: Change) -> None:
    """Let other programs set what is live; `change` returns '' or the refusal. Raises ImportError: not installed."""
    from dynamic_reconfigure.server import Server

    class RefusingServer(Server):
        """Upstream's server. A value out of the limits is refused, and not moved into them."""

        def _clamp(self, config: dict[str, object]) -> None:
            """See Server."""

    live = {name: each for name, each in parameters.declared().items() if each.live}
    for folder in {name.rpartition("/")[0] for name in live}:
        here = {name[len(folder) + 1 :]: each for name, each in live.items() if name.rpartition("/")[0] == folder}
        RefusingServer(_describe(here), partial(_apply, parameters, change, folder), folder)


def _apply(parameters: Parameters, change: Change, folder: str, config: Config, _level: int) -> Config:
    """Apply a configuration, and return what is in use. Raises ServiceException with the reason of a refusal."""
    known, given = parameters.declared(), {f"{folder}/{name}": config[name] for name in config if name != "groups"}
    changed = {name: value for name, value in given.items() if name not in known or known[name].value != value}
    if changed and (reason := change(changed)):
        raise rospy.ServiceException(reason)
    config.update({name.rpartition("/")[2]: parameters.declared()[name].value for name in given})
    return config


def _describe(live: Mapping[str, Declaration]) -> SimpleNamespace:
    """Return what upstream generates as a class of constants."""
    described = [
        {"name": name, "type": _KINDS[type(each.value)], "description": f"{each.live} ({each.expected})", **_UNUSED}
        for name, each in live.items()
    ]
    group = {"name": "Default", "type": "", "id": 0, "parent": 0, "state": True, "groups": [], "parameters": described}
    return SimpleNamespace(
        config_description=group,
        defaults={name: each.value for name, each in live.items()},
        min={name: each.limits[0] for name, each in live.items()},
        max={name: each.limits[1] for name, each in live.items()},
    )
