"""Parameters of a node of ROS 2. Those of other nodes are out of reach: each node keeps its own.

Those that a node sets are in a file of the run, too, and outlive the node: an emergency stop is among them.
"""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from ur_nodes.file_facts import FileFacts, file_of_run

_SET = "parameters"
_LONGEST = 10_000  # characters of a value that is set while the node runs


class RosParameters:
    """See `ports.parameters.ParameterStore`. '~a/b' and '/name/of/node/a/b' are the parameter 'a.b' of the node."""

    def __init__(self, node: Node) -> None:
        self._node = node
        name = node.get_fully_qualified_name()
        self._prefix = f"{name}/"
        run = file_of_run()
        self._file = FileFacts(simulated_time=False, file=run.with_name(f"{run.stem}{name.replace('/', '.')}.json"))
        for own, value in self._file.get(_SET, {}).items():
            self._keep(own, value)
        node.add_on_set_parameters_callback(_judge)

    def resolve(self, name: str) -> str:
        return self._prefix + name[1:] if name.startswith("~") else name

    def has(self, name: str) -> bool:
        own = self._own(name)
        return own is not None and bool(self._node.has_parameter(own) or self._node.get_parameters_by_prefix(own))

    def get(self, name: str) -> object:
        own = self._own(name)
        if own is not None and self._node.has_parameter(own):
            return _plain(self._node.get_parameter(own).value)
        below = {} if own is None else self._node.get_parameters_by_prefix(own)
        if not below:
            raise KeyError(name)
        tree: dict[str, Any] = {}
        for path, parameter in below.items():
            *folders, last = path.split(".")
            place = tree
            for folder in folders:
                place = place.setdefault(folder, {})
            place[last] = _plain(parameter.value)
        return tree

    def set(self, name: str, value: object) -> None:
        """See ParameterStore. Raises ValueError: it is another node's; OSError: the file cannot be written."""
        own = self._own(name)
        if own is None:
            raise ValueError(f"{name}: a parameter of another node, which ROS 2 does not let this one set")
        if isinstance(value, dict):
            for key, each in value.items():
                self.set(f"{name}/{key}", each)
        else:
            self._keep(own, value)
            self._file.set(_SET, self._file.get(_SET, {}) | {own: value})

    def names(self) -> list[str]:
        return sorted(self._prefix + name.replace(".", "/") for name in self._node.get_parameters_by_prefix(""))

    def _keep(self, own: str, value: object) -> None:
        """Set a parameter. Other programs can set declared ones only, so that they cannot fill the memory."""
        if not self._node.has_parameter(own):
            self._node.declare_parameter(own, value, ParameterDescriptor(dynamic_typing=True))
        self._node.set_parameters([Parameter(own, value=value)])

    def _own(self, name: str) -> str | None:
        full = self.resolve(name)
        if not full.startswith(self._prefix):
            return None
        return full.removeprefix(self._prefix).strip("/").replace("/", ".")


def _judge(parameters: list[Parameter]) -> SetParametersResult:
    """Refuse values that are too long to be kept."""
    for each in parameters:
        if len(str(each.value)) > _LONGEST:
            return SetParametersResult(successful=False, reason=f"{each.name}: longer than {_LONGEST} characters")
    return SetParametersResult(successful=True)


def _plain(value: Any) -> object:
    return value.tolist() if hasattr(value, "typecode") else value
