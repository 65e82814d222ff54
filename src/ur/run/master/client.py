"""A client of a ROS master (http://wiki.ros.org/ROS/Master_API and Parameter_Server_API)."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ur.run.master.xml_rpc import CallRefused, Unanswered, WrongServer, call_method
from ur.source.data_classes import dataclass
from ur.source.diagnostic import UserError, user_error

CALLER = "/roslaunch"  # the name under which roslaunch speaks: tools look for it
DEFAULT_PORT = 11311


NodesByName = list[tuple[str, list[str]]]
SystemState = tuple[NodesByName, NodesByName, NodesByName]
"""Publishers, subscribers and services of a ROS system: names, and the nodes that have them."""


@dataclass(frozen=True, slots=True)
class Master:
    """A client of the master at an address. Calls raise Unanswered, or CallRefused on a failure status."""

    uri: str
    host: str
    port: int
    timeout: float = 3.0

    def call(self, method: str, *arguments: object) -> Any:
        """Call a method of the master API and return its value."""
        return _value(call_method((self.host, self.port), method, [CALLER, *arguments], self.timeout))

    def call_many(self, calls: Sequence[tuple[str, tuple[object, ...]]]) -> list[Any]:
        """Call many methods in one request. Each result is the value, or a CallRefused in its place."""
        batch = [{"methodName": name, "params": [CALLER, *arguments]} for name, arguments in calls]
        results = call_method((self.host, self.port), "system.multicall", [batch], self.timeout)
        if not isinstance(results, list) or len(results) != len(batch):
            raise WrongServer(f"expected {len(batch)} answers of a ROS master, got {str(results)[:80]!r}")
        return [_result(each) for each in results]

    def get_system_state(self) -> SystemState:
        """Return publishers, subscribers and services, each with the nodes that have it."""
        state = self.call("getSystemState")
        if not isinstance(state, list) or len(state) != 3 or not all(map(_is_nodes_by_name, state)):
            raise WrongServer(f"expected the state of a ROS system, got {str(state)[:80]!r}")
        return state[0], state[1], state[2]

    def get_run_id(self) -> str | None:
        """The run id on the parameter server. None when there is none."""
        try:
            return str(self.call("getParam", "/run_id"))
        except CallRefused:
            return None

    def set_parameters(self, parameters: Mapping[str, object], clear: Iterable[str] = ()) -> None:
        """Delete namespaces, then set parameters, all in one request. Raises CallRefused with the parameter's name."""
        removals = [("deleteParam", (name,)) for name in unify_clear(clear)]
        settings = [("setParam", item) for item in parameters.items()]
        if not removals and not settings:
            return
        results = self.call_many([*removals, *settings])[len(removals) :]  # deleting a missing parameter is no error
        for (_, (name, _)), result in zip(settings, results, strict=True):
            if isinstance(result, CallRefused):
                raise CallRefused(f"{name}: {result}")

    def find_live_nodes(self, names: Sequence[str]) -> list[str]:
        """Return the nodes, of these, that are registered and answer."""
        found = self.call_many([("lookupNode", (name,)) for name in names])
        return [
            name for name, uri in zip(names, found, strict=True) if isinstance(uri, str) and _answers(uri, self.timeout)
        ]

    def remove_dead_nodes(self, names: Sequence[str]) -> None:
        """Remove registered nodes that no longer answer from the master, as `rosnode cleanup` does."""
        found = self.call_many([("lookupNode", (name,)) for name in names])
        dead = {
            name: uri
            for name, uri in zip(names, found, strict=True)
            if isinstance(uri, str) and not _answers(uri, self.timeout)
        }
        if not dead:
            return
        publishers, subscribers, services = self.get_system_state()
        calls: list[tuple[str, tuple[object, ...]]] = []
        for method, topics in (("unregisterPublisher", publishers), ("unregisterSubscriber", subscribers)):
            calls += [(method, (topic, dead[node])) for topic, nodes in topics for node in nodes if node in dead]
        owners = [(service, node) for service, nodes in services for node in nodes if node in dead]
        for service, _node in owners:
            calls.append(("unregisterService", (service, self.call("lookupService", service))))
        names_in_order = [
            node for topics in (publishers, subscribers) for _, nodes in topics for node in nodes if node in dead
        ] + [node for _, node in owners]
        batch = [
            {"methodName": method, "params": [node, *arguments]}
            for node, (method, arguments) in zip(names_in_order, calls, strict=True)
        ]
        call_method((self.host, self.port), "system.multicall", [batch], self.timeout)


def parse_master_uri(uri: str) -> Master:
    """Parse ROS_MASTER_URI. Raises UserError unless it is `http://HOST:PORT`.

    An IPv6 address as HOST is in brackets (RFC 3986), which `host` of the result does not have.
    """
    scheme, found, rest = uri.partition("://")
    host, _, port = rest.rstrip("/").rpartition(":")
    literal = len(host) > 2 and host.startswith("[") and host.endswith("]")
    bad = not host or (not literal and any(each in host for each in ":[]"))
    # Only ASCII digits: str.isdigit() also accepts others, some of which int() refuses.
    if bad or not found or scheme != "http" or not re.fullmatch("[0-9]{1,5}", port) or not 0 < int(port) < 65536:
        raise user_error(
            f"ROS_MASTER_URI: {uri!r}, expected http://HOST:PORT",
            rule="bad-master-uri",
            help="an IPv6 address stands in brackets: http://[::1]:11311" if host.count(":") > 1 else "unset it",
            subject=uri,
        )
    return Master(uri, host[1:-1] if literal else host, int(port))


def format_master_uri(host: str, port: int) -> str:
    """Format ROS_MASTER_URI for a master, with an IPv6 address in brackets."""
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def unify_clear(names: Iterable[str]) -> list[str]:
    """Return the namespaces to delete, without those inside another: deleting them twice would fail."""
    spaces = {name if name.endswith("/") else name + "/": None for name in names}
    return [name for name in spaces if not any(name != other and name.startswith(other) for other in spaces)]


def _value(answer: object) -> object:
    if not isinstance(answer, list) or len(answer) != 3:
        raise WrongServer(f"expected the answer of a ROS master, got {str(answer)[:80]!r}")
    code, message, value = answer
    if code != 1:
        raise CallRefused(str(message))
    return value


def _is_nodes_by_name(kind: object) -> bool:
    return isinstance(kind, list) and all(
        isinstance(pair, list)
        and len(pair) == 2
        and isinstance(pair[0], str)
        and isinstance(pair[1], list)
        and all(isinstance(node, str) for node in pair[1])
        for pair in kind
    )


def _result(each: object) -> object:
    if isinstance(each, dict):
        return CallRefused(str(each.get("faultString", each)))
    if not isinstance(each, list) or not each:
        raise Unanswered(f"expected the answer of a ROS master, got {str(each)[:80]!r}")
    try:
        return _value(each[0])
    except CallRefused as refusal:
        return refusal


def _answers(uri: str, timeout: float) -> bool:
    try:
        node = parse_master_uri(uri)
        call_method((node.host, node.port), "getPid", [CALLER], min(timeout, 0.5))
    except (Unanswered, UserError):
        return False
    except CallRefused:
        return True
    return True
