"""Events of a run for its clients, and commands from clients: values, and each as one line of JSON.

A subscriber first gets `RunStarted`, then one `NodeChanged` and one `NodeReadiness` with the present state of each
node, then `Synchronised`; from there on every event. Output lines and statistics are sent only after a `Watch` has
requested them.
"""

from typing import Any, Literal

from ur.run.supervisor.events import KillNode, NodeRequest, RestartNode, StartNode, StopNode
from ur.source.data_classes import dataclass

NodeState = Literal["waiting", "starting", "running", "stopping", "ended"]
Severity = Literal["", "debug", "info", "warning", "error", "fatal"]
OutputSource = Literal["out", "err", "log"]


class BadLineError(ValueError):
    """A line that is not a valid event or command. The text is the reason."""


@dataclass(frozen=True, slots=True)
class RunStarted:
    """The run: its id, the supervisor's process, the launch file's name, its address and its log folder.

    `started` is in s since the epoch. `terminal` names the node that owns the terminal, '' when there is none.
    """

    run: str
    pid: int
    title: str
    master_uri: str
    log_folder: str
    started: float
    detached: bool = False
    terminal: str = ""


@dataclass(frozen=True, slots=True)
class NodeChanged:
    """The current status of a node.

    `waiting`: not started yet, or restarted in `restart_in` s. `ended`: not restarted automatically; then `exit_code`
    or `signal` describe its last end (both None: it could not be started, or its start was never requested), and
    `reason` tells the user why it could not be started, or is not restarted. `held`: the user stopped it. `core`: the
    master and rosout, which accept no commands. `log` is the file with its output, `program` its executable.
    """

    name: str
    state: NodeState
    pid: int | None = None
    exit_code: int | None = None
    signal: int | None = None
    restarts: int = 0
    restart_in: float | None = None
    reason: str = ""
    held: bool = False
    core: bool = False
    required: bool = False
    log: str = ""
    program: str = ""


@dataclass(frozen=True, slots=True)
class NodeReadiness:
    """Readiness of a node: it runs, is registered with the master, and meets its `ready:` comment.

    `missing` lists unmet conditions and their reasons, as text. Only checked while a client subscribes or waits.
    """

    name: str
    ready: bool
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class OutputLine:
    """A line that a node printed, with colours, safe for a terminal.

    `stream` is "log" for a line read back from a log.
    """

    name: str
    stream: OutputSource
    severity: Severity
    text: str


@dataclass(frozen=True, slots=True)
class NodeStats:
    """Resource usage of a node and its child processes: `cpu` in cores (1.0 is one), `memory` (resident) in bytes."""

    name: str
    cpu: float
    memory: int


@dataclass(frozen=True, slots=True)
class StatsSampled:
    """One sample of every running node."""

    nodes: tuple[NodeStats, ...]


@dataclass(frozen=True, slots=True)
class Notice:
    """A message of the run itself for the user: a crash report, the reason why it stops. May have several lines."""

    severity: Severity
    text: str


@dataclass(frozen=True, slots=True)
class LinkChanged:
    """The state of the link to the robot: `lost` for `seconds` so far, sent twice a second; or restored after them."""

    robot: str
    lost: bool
    seconds: float


@dataclass(frozen=True, slots=True)
class Synchronised:
    """The end of the current state; later events are new."""


@dataclass(frozen=True, slots=True)
class RunStopping:
    """The run starts to end; `cause` is a text for the user, '' without one."""

    cause: str


@dataclass(frozen=True, slots=True)
class RunEnded:
    """All processes have ended; this is the last event. `exit_code` is that of the run."""

    exit_code: int


RunEvent = (
    RunStarted
    | NodeChanged
    | NodeReadiness
    | OutputLine
    | StatsSampled
    | Notice
    | LinkChanged
    | Synchronised
    | RunStopping
    | RunEnded
)


@dataclass(frozen=True, slots=True)
class Watch:
    """A subscription beyond changes: output lines, statistics, readiness. It replaces an earlier one."""

    output: bool = False
    stats: bool = False
    readiness: bool = False


@dataclass(frozen=True, slots=True)
class StopRun:
    """End the run, as Ctrl-C does; repeated commands end it faster. `reason` is a text for the user."""

    reason: str = "asked to stop"


RunCommand = Watch | NodeRequest | StopRun

_EVENTS: dict[str, Any] = {
    kind.__name__: kind
    for kind in (
        RunStarted,
        NodeChanged,
        NodeReadiness,
        OutputLine,
        StatsSampled,
        Notice,
        LinkChanged,
        Synchronised,
        RunStopping,
        RunEnded,
    )
}
_COMMANDS: dict[str, Any] = {
    kind.__name__: kind for kind in (Watch, StartNode, StopNode, RestartNode, KillNode, StopRun)
}


def dump_line(item: RunEvent | RunCommand) -> bytes:
    """Encode an event or command as one line of JSON: `kind` first, then its fields."""
    import json  # only for those who watch
    from dataclasses import asdict

    return json.dumps({"kind": type(item).__name__, **asdict(item)}, ensure_ascii=False).encode("utf-8") + b"\n"


def parse_event(line: bytes) -> RunEvent:
    """Decode an event from a line. Unknown fields are ignored. Raises BadLineError."""
    event: RunEvent = _parse(line, _EVENTS)
    return event


def parse_command(line: bytes) -> RunCommand:
    """Decode a command from a line. Raises BadLineError."""
    command: RunCommand = _parse(line, _COMMANDS)
    return command


def find_severity(text: str) -> Severity:
    """Find the severity of a log line as rosconsole and rospy write it: `[ WARN] [1234.5]: text`, colours allowed."""
    while text.startswith("\x1b["):
        text = text.partition("m")[2]
    return _SEVERITIES.get(text[1:9].partition("]")[0].strip(), "") if text.startswith("[") else ""


_SEVERITIES: dict[str, Severity] = {
    "DEBUG": "debug",
    "INFO": "info",
    "WARN": "warning",
    "WARNING": "warning",
    "ERROR": "error",
    "FATAL": "fatal",
    "CRITICAL": "fatal",
}


def _parse(line: bytes, kinds: dict[str, Any]) -> Any:
    from ur.source.foreign.json_values import BadJsonError, convert_json, read_json  # only for those who watch

    try:
        found = read_json(line, dict[str, Any], len(line))
        kind = kinds[found.pop("kind")]
    except (BadJsonError, KeyError, TypeError):
        raise BadLineError(f"{line[:80]!r}, expected one of {', '.join(kinds)} as JSON") from None
    try:
        return convert_json(found, kind)
    except BadJsonError as problem:
        raise BadLineError(f"{kind.__name__}: {problem}") from None
