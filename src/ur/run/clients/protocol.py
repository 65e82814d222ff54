"""Events of a run for its clients, and commands that clients may send: values, and each as one line of JSON.

A subscriber first gets `RunStarted`, then one `NodeChanged` and one `NodeReadiness` for each node as it is now, then
`Synchronised`; from there on every event. Output lines and statistics come only after `Watch` asked for them.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

NodeState = Literal["waiting", "starting", "running", "stopping", "ended"]
Severity = Literal["", "debug", "info", "warning", "error", "fatal"]
OutputSource = Literal["out", "err", "log"]


class BadLineError(ValueError):
    """A line that is no event or command of this protocol. The text is the reason."""


@dataclass(frozen=True, slots=True)
class RunStarted:
    """The run: its id, the supervisor's process, the launch file's name, and where it is connected and writes to.

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

    `waiting`: not started yet, or due again in `restart_in` s. `ended`: not started again by itself; then `exit_code`
    or `signal` are those of its last end (both None: it could not be started, or was never asked to), `reason` is for
    people: why it could not be started, or why it is not started again. `held`: a person stopped it. `core`: the master
    and rosout, which take no commands. `log` is the file with what it prints, `program` its executable, `folder` where
    it is started.
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
    folder: str = ""


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
    """A line that a node printed, colours kept, made safe for a terminal. `stream` is "log" when it was read back."""

    name: str
    stream: OutputSource
    severity: Severity
    text: str


@dataclass(frozen=True, slots=True)
class NodeStats:
    """Resource usage of a node, child processes included: `cpu` in cores (1.0 is one), `memory` (resident) in bytes."""

    name: str
    cpu: float
    memory: int


@dataclass(frozen=True, slots=True)
class StatsSampled:
    """One sample of every node that runs."""

    nodes: tuple[NodeStats, ...]


@dataclass(frozen=True, slots=True)
class Notice:
    """A message of the run itself for people: a crash report, the reason why it stops. May hold several lines."""

    severity: Severity
    text: str


@dataclass(frozen=True, slots=True)
class LinkChanged:
    """The link to the robot: `lost` for so long (s) by now, sent twice a second; or restored after so long."""

    robot: str
    lost: bool
    seconds: float


@dataclass(frozen=True, slots=True)
class Synchronised:
    """The end of the current state; later events are new."""


@dataclass(frozen=True, slots=True)
class RunStopping:
    """The run ends; `cause` is text for people, '' without one."""

    cause: str


@dataclass(frozen=True, slots=True)
class RunEnded:
    """Nothing is left; this is the last event. `exit_code` is that of the run."""

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
    """Subscription beyond changes: output lines, statistics, readiness. Replaces an earlier one."""

    output: bool = False
    stats: bool = False
    readiness: bool = False


@dataclass(frozen=True, slots=True)
class StartNode:
    """Start a node that has ended or waits. Nothing when it runs."""

    name: str


@dataclass(frozen=True, slots=True)
class StopNode:
    """Stop a node and keep it stopped: SIGINT, SIGTERM, SIGKILL. The run goes on, also when the node is required."""

    name: str


@dataclass(frozen=True, slots=True)
class RestartNode:
    """Stop a node and start it again; this once with `prefix` in front of its program, in place of its own prefix."""

    name: str
    prefix: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class KillNode:
    """SIGKILL a node and keep it stopped."""

    name: str


@dataclass(frozen=True, slots=True)
class StopRun:
    """End the run, as Ctrl-C does; again is faster. `reason` is for people."""

    reason: str = "asked to stop"


RunCommand = Watch | StartNode | StopNode | RestartNode | KillNode | StopRun

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
    """An event or command as one line of JSON: its fields, and `kind` first."""
    import json  # only for those who watch

    return json.dumps({"kind": type(item).__name__, **asdict(item)}, ensure_ascii=False).encode("utf-8") + b"\n"


def parse_event(line: bytes) -> RunEvent:
    """The event in a line. Fields that this version does not know are left out. Raises BadLine."""
    event: RunEvent = _parse(line, _EVENTS)
    return event


def parse_command(line: bytes) -> RunCommand:
    """The command in a line. Raises BadLine."""
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
