"""Parameters of a node of ROS 2. Those of other nodes are read from a file of the run, as its launch files give them.

Those that a node sets are in a file of the run, too, and outlive the node: an emergency stop is among them.
"""

import threading
from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.parameter import Parameter

from ur_nodes.file_facts import FileFacts, file_of_run, given_parameters
from ur_nodes.ports.parameters import READ_ONLY, Declaration, Parameters
from ur_nodes.ros2.reception import ReceivingNode

_SET = "parameters"
_PLAIN = (bool, int, float, str)


class RosParameters:
    """See `ports.parameters.ParameterStore`. '~a/b' and '/name/of/node/a/b' are the parameter 'a.b' of the node."""

    def __init__(self, node: ReceivingNode) -> None:
        self._node = node
        self._unset: set[str] = set()  # declared with their defaults, so that they are listed
        self._keepers: set[int] = set()  # threads that set a parameter of their own node
        name = node.get_fully_qualified_name()
        self._prefix = f"{name}/"
        run = file_of_run()
        self._file = FileFacts(simulated_time=False, file=run.with_name(f"{run.stem}{name.replace('/', '.')}.json"))
        self._given = FileFacts(simulated_time=False, file=given_parameters())
        for own, value in self._file.get(_SET, {}).items():
            self._keep(own, value)

    def resolve(self, name: str) -> str:
        return self._prefix + name[1:] if name.startswith("~") else name

    def has(self, name: str) -> bool:
        own = self._own(name)
        if own is None:
            return self._given.get(_absolute(name)) is not None
        return bool(self._is_set(own) or self._below(own))

    def get(self, name: str) -> object:
        own = self._own(name)
        if own is None:
            if (found := self._given.get(_absolute(name))) is None:
                raise KeyError(name)
            return found
        if self._is_set(own):
            return _plain(self._node.get_parameter(own).value)
        below = self._below(own)
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

    def serve(self, parameters: Parameters, change: Callable[[dict[str, object]], str]) -> None:
        """Let other programs see what the node has read, and set what is live; `change` returns '' or the refusal."""
        for full, each in parameters.declared().items():
            own, descriptor = self._own(full), ParameterDescriptor(dynamic_typing=True)
            if own and self._node.has_parameter(own):  # a number may be given as 1 and set to 0.5
                self._node.set_descriptor(own, descriptor)
            elif own and isinstance(each.value, _PLAIN):
                self._unset.add(own)
                self._node.declare_parameter(own, each.value, descriptor)
        self._node.add_on_set_parameters_callback(lambda given: self._judge(given, change))
        self._node.describe = lambda own: _describe(own, parameters.declared().get(self._full(own)))

    def _keep(self, own: str, value: object) -> None:
        """Set a parameter. Other programs can set declared ones only, so that they cannot fill the memory."""
        self._keepers.add(threading.get_ident())
        if not self._node.has_parameter(own):
            self._node.declare_parameter(own, value, ParameterDescriptor(dynamic_typing=True))
        self._node.set_parameters([Parameter(own, value=value)])
        self._keepers.discard(threading.get_ident())
        self._unset.discard(own)

    def _judge(self, parameters: list[Parameter], change: Callable[[dict[str, object]], str]) -> SetParametersResult:
        """Apply what another program sets, or refuse it."""
        if threading.get_ident() in self._keepers:
            return SetParametersResult(successful=True)
        reason = change({self._full(each.name): _plain(each.value) for each in parameters})
        if not reason:
            self._unset.difference_update(each.name for each in parameters)
        return SetParametersResult(successful=not reason, reason=reason)

    def _is_set(self, own: str) -> bool:
        return own not in self._unset and self._node.has_parameter(own)

    def _below(self, own: str) -> dict[str, Parameter]:
        found = self._node.get_parameters_by_prefix(own)
        return {path: each for path, each in found.items() if each.name not in self._unset}

    def _full(self, own: str) -> str:
        return self._prefix + own.replace(".", "/")

    def _own(self, name: str) -> str | None:
        full = self.resolve(name)
        if not full.startswith(self._prefix):
            return None
        return full.removeprefix(self._prefix).strip("/").replace("/", ".")


def _describe(own: str, declared: Declaration | None) -> ParameterDescriptor | None:
    """Return the descriptor of a parameter for other programs; None: the node has not read it."""
    if declared is None:
        return None
    descriptor = ParameterDescriptor(
        name=own,
        type=Parameter(own, value=declared.value).type_.value if isinstance(declared.value, _PLAIN) else 0,
        description=declared.live or declared.expected,
        additional_constraints=declared.expected if declared.live else f"{declared.expected}; {READ_ONLY}",
        read_only=not declared.live,
    )
    low, high = declared.limits
    if type(declared.value) is float:
        descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
    elif type(declared.value) is int:
        descriptor.integer_range = [IntegerRange(from_value=int(low), to_value=int(high))]
    return descriptor


def _absolute(name: str) -> str:
    return name if name.startswith("/") else f"/{name}"


def _plain(value: Any) -> object:
    return value.tolist() if hasattr(value, "typecode") else value
