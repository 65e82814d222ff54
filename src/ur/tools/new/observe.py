"""Observation of a running node: it is started with a separate master, and its registrations are recorded."""

import os
import signal
import socket
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import Any
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

from ur.run.master.client import parse_master_uri
from ur.run.master.xml_rpc import CallRefused, call_method
from ur.source.diagnostic import user_error, user_error_about
from ur.tools.new.parts import NodeTopic, Observed

NAME = "/observed"
_ASKED = frozenset({"getParam", "hasParam", "subscribeParam", "searchParam"})
_COMMON = frozenset({"/rosout", "/clock", "/tf", "/tf_static"})
_COMMON_PARAMETERS = ("/use_sim_time", "/tcp_keepalive", "/rosversion", "/rosdistro", "/run_id", "/roslaunch", "/ur")
_SETTLED, _BEGUN = 1.5, 6.0  # s without anything new, and that after which a node has no topics of its own


def observe_node(
    command: Sequence[str], environment: Mapping[str, str], seconds: float, report: Callable[[str], None]
) -> Observed:
    """Start a node and return what it registers with its master. The node and the master end with this call.

    `command` gets `__name` and `__log` in addition. Waits until there was no new call for a while, at most `seconds`.
    Raises UserError if the node ends before it registers, or never does.
    """
    with tempfile.TemporaryDirectory() as folder, _master(folder, environment) as (port, listener):
        own = {**environment, "ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost"}
        own |= {"ROS_LOG_DIR": folder, "ROS_HOME": folder}
        report(f"looking at {' '.join(command)}")
        node = _start([*command, f"__name:={NAME.strip('/')}"], own)
        try:
            deadline = time.monotonic() + seconds
            while time.monotonic() < deadline and node.poll() is None:
                if listener.registered and time.monotonic() - listener.latest > listener.patience:
                    break
                time.sleep(0.05)
            if not listener.registered:
                how = "never registered with its master" if node.poll() is None else f"ended with {node.returncode}"
                raise user_error_about(
                    " ".join(command), f"{how}, expected a ROS node", rule="no-node", help="try it by hand first"
                )
            if node.poll() is not None:
                report(
                    f"the node ended with {node.returncode} while it was looked at, so this may not be all; "
                    "a parameter that it must have is given after --, as _NAME:=VALUE"
                )
            return listener.observed()
        finally:
            _end(node)


class _Listener:
    """Forwards every call to the master, and records the node's requests."""

    def __init__(self, master: str) -> None:
        self._master = parse_master_uri(master)
        self._lock = threading.Lock()
        self.registered = False
        self.latest = time.monotonic()
        self._topics: dict[tuple[str, bool], str] = {}
        self._services: dict[str, None] = {}
        self._asked: dict[str, None] = {}

    @property
    def patience(self) -> float:
        """The time (s) without anything new after which all is known; longer while only what every node has is."""
        return _SETTLED if any(_counts(name) for name, _ in self._topics) else _BEGUN

    def _dispatch(self, method: str, parameters: tuple[Any, ...]) -> Any:
        with self._lock:
            self._remember(method, parameters)
            try:
                return self._ask(method, *parameters)
            except CallRefused as problem:
                return [-1, str(problem), 0]

    def _ask(self, method: str, *parameters: object) -> object:
        return call_method((self._master.host, self._master.port), method, list(parameters), self._master.timeout)

    def _remember(self, method: str, parameters: tuple[Any, ...]) -> None:
        if method == "system.multicall":
            for call in parameters[0]:
                self._remember(call["methodName"], tuple(call["params"]))
            return
        if not parameters or parameters[0] != NAME:
            return
        before = (len(self._topics), len(self._services), len(self._asked))
        if method in ("registerPublisher", "registerSubscriber"):
            self.registered = True
            self._topics[parameters[1], method == "registerPublisher"] = parameters[2]
        elif method == "registerService":
            self.registered = True
            self._services[parameters[1]] = None
        elif method in _ASKED:
            self._asked[_full(parameters[1])] = None
        if before != (len(self._topics), len(self._services), len(self._asked)):
            self.latest = time.monotonic()

    def observed(self) -> Observed:
        """Return the observed interface of the node."""
        with self._lock:
            values = self._ask("getParam", NAME, NAME)
        known = dict(_flatten(values[2])) if isinstance(values, list) and values[0] == 1 else {}
        asked = [name for name in self._asked if not name.startswith(_COMMON_PARAMETERS)]
        parameters: dict[str, object] = {}
        for name in asked:
            if name.startswith(f"{NAME}/"):
                parameters.setdefault(name.removeprefix(f"{NAME}/"), None)
        parameters |= known
        topics = [NodeTopic(_relative(name), kind, out) for (name, out), kind in self._topics.items() if _counts(name)]
        services = [
            _relative(name) for name in self._services if not name.endswith(("/get_loggers", "/set_logger_level"))
        ]
        return Observed(
            tuple(sorted(topics, key=lambda each: (each.published, each.name))), tuple(services), parameters
        )


def _counts(topic: str) -> bool:
    return topic not in _COMMON and not topic.endswith(("/parameter_updates", "/parameter_descriptions", "/bond"))


def _relative(name: str) -> str:
    return f"~{name.removeprefix(NAME + '/')}" if name.startswith(f"{NAME}/") else name.removeprefix("/")


def _full(name: str) -> str:
    if name.startswith("~"):
        return f"{NAME}/{name[1:]}"
    return name if name.startswith("/") else f"/{name}"


def _flatten(values: object, above: str = "") -> Iterator[tuple[str, object]]:
    if isinstance(values, dict):
        for name, value in values.items():
            yield from _flatten(value, f"{above}{name}/")
    elif above:
        yield above.removesuffix("/"), values


class _Handler(SimpleXMLRPCRequestHandler):
    rpc_paths = ()  # nodes ask at "/", and some at "/RPC2"


@contextmanager
def _master(folder: str, environment: Mapping[str, str]) -> Iterator[tuple[int, _Listener]]:
    port = _free_port()
    uri = f"http://localhost:{port}"
    own = {**environment, "ROS_MASTER_URI": uri, "ROS_HOSTNAME": "localhost", "ROS_LOG_DIR": folder, "ROS_HOME": folder}
    master = _start(["rosmaster", "--core", "-p", str(port)], own)
    try:
        _wait_for(port, master)
        listener = _Listener(uri)
        with SimpleXMLRPCServer(("localhost", 0), _Handler, logRequests=False, allow_none=True) as server:
            server.register_instance(listener)
            thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True)
            thread.start()
            try:
                yield server.server_address[1], listener
            finally:
                server.shutdown()
                thread.join()
    finally:
        _end(master)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        port: int = probe.getsockname()[1]
        return port


def _wait_for(port: int, master: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + 60.0
    while master.poll() is None and time.monotonic() < deadline:
        with socket.socket() as probe:
            if probe.connect_ex(("localhost", port)) == 0:
                return
        time.sleep(0.05)
    raise user_error("rosmaster does not start, expected a master", rule="no-master", help="try it: rosmaster --core")


def _start(command: Sequence[str], environment: Mapping[str, str]) -> subprocess.Popen[bytes]:
    try:
        return subprocess.Popen(
            command,
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error_about(command[0], f"{reason}, expected a program", rule="no-program") from None


def _end(process: subprocess.Popen[bytes]) -> None:
    for number in (signal.SIGINT, signal.SIGKILL):
        with suppress(ProcessLookupError):
            os.killpg(process.pid, number)
        with suppress(subprocess.TimeoutExpired):
            process.wait(5.0)
