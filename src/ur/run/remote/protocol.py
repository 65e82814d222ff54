"""Requests to a robot for its share of a run, and the answers: values, and each as JSON that is checked when read."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, TypeVar, cast

MAX_BYTES = 1 << 18
_CLIENT = re.compile(r"[0-9A-Za-z_-]{1,64}")
_NODE = re.compile(r"(/[A-Za-z][0-9A-Za-z_]*)+")
_Value = TypeVar("_Value")


@dataclass(frozen=True, slots=True)
class Client:
    """A run on another computer that uses a robot's share of a run.

    `client` is the random id of that run (UR_CLIENT), `name` the host name of its computer, `machine` the identity of
    its user there (`ur.run.record.computer.describe_user`), `pid` its process, `nodes` the full names of its nodes.
    `detached`: it has no process of its own and never leaves. `since` is in s since the epoch, of the robot's clock.
    """

    client: str
    name: str
    machine: str
    pid: int
    nodes: tuple[str, ...] = ()
    detached: bool = False
    since: float = 0.0


@dataclass(frozen=True, slots=True)
class ShareRequest:
    """`machine` is the robot's name in the launch file, `words` the arguments of `ur launch` after its options.

    `nodes` are the full names of the share's nodes, as far as they are the same each time. `client` asks; `alive` are
    the ids of all clients of its computer that still run.
    """

    action: Literal["begin", "end"]
    machine: str
    words: tuple[str, ...]
    options: tuple[str, ...] = ()
    nodes: tuple[str, ...] = ()
    master_uri: str = ""
    host: str = ""
    client: Client | None = None
    alive: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Problem:
    """The reason why a share could not start: a message, a help line and the id of the rule.

    `place` is the file, line and column that it is about, '' for the arguments or the computer.
    """

    message: str
    help: str = ""
    rule: str = ""
    place: str = ""


@dataclass(frozen=True, slots=True)
class ShareAnswer:
    """`run` is the id of the share's run, '' without one; `found`: it ran before; `running`: nodes of other runs.

    `clients` are the names of the other computers that use these runs; `names` are other full names for nodes of this
    client that have the name of a node of theirs. After `end`, `ended` are the runs that have
    ended and `kept` those that go on for `clients`. `renamed_from` is the robot's old name under which the share ran
    before it was started again.
    """

    run: str = ""
    found: bool = False
    running: tuple[str, ...] = ()
    clients: tuple[str, ...] = ()
    names: Mapping[str, str] = field(default_factory=dict)
    ended: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()
    renamed_from: str = ""
    problem: Problem | None = None


def dump(value: ShareRequest | ShareAnswer) -> str:
    """A value as one line of JSON."""
    return json.dumps(asdict(value))


def parse_request(text: str) -> ShareRequest:
    """Read a request from another computer. Raises ValueError or TypeError for anything else."""
    fields = _load(text)
    if fields.get("action") not in ("begin", "end"):
        raise ValueError("action")
    return ShareRequest(
        action=cast(Literal["begin", "end"], fields["action"]),
        machine=_take(fields, "machine", _name),
        words=_take(fields, "words", _list(_word)),
        options=_take(fields, "options", _list(_word), ()),
        nodes=_take(fields, "nodes", _list(_node), ()),
        master_uri=_take(fields, "master_uri", _name, ""),
        host=_take(fields, "host", _name, ""),
        client=parse_client(fields["client"]) if fields.get("client") is not None else None,
        alive=_take(fields, "alive", _list(_identity), ()),
    )


def parse_client(fields: object) -> Client:
    """Check what describes a client. Raises ValueError or TypeError."""
    if not isinstance(fields, dict):
        raise TypeError("client")
    return Client(
        client=_take(fields, "client", _identity),
        name=_take(fields, "name", _name),
        machine=_take(fields, "machine", _name),
        pid=_take(fields, "pid", _count),
        nodes=_take(fields, "nodes", _list(_node), ()),
        detached=_take(fields, "detached", _flag, False),
        since=_take(fields, "since", _seconds, 0.0),
    )


def parse_answer(text: str) -> ShareAnswer:
    """Read a robot's answer. Raises ValueError or TypeError for anything else."""
    fields = _load(text)
    return ShareAnswer(
        run=_take(fields, "run", _line, ""),
        found=_take(fields, "found", _flag, False),
        running=_take(fields, "running", _list(_line), ()),
        clients=_take(fields, "clients", _list(_name), ()),
        names=_take(fields, "names", _names, {}),
        ended=_take(fields, "ended", _list(_line), ()),
        kept=_take(fields, "kept", _list(_line), ()),
        renamed_from=_take(fields, "renamed_from", _line, ""),
        problem=_parse_problem(fields.get("problem")),
    )


def _parse_problem(fields: object) -> Problem | None:
    if fields is None:
        return None
    if not isinstance(fields, dict):
        raise TypeError("problem")
    message, help_, rule, place = (_take(fields, name, _line, "") for name in ("message", "help", "rule", "place"))
    return Problem(message, help_, rule, place)


def check_printable(text: object, limit: int = 64) -> str:
    """Return a name that another computer has sent if it can be shown as it is. Raises ValueError or TypeError."""
    if not isinstance(text, str):
        raise TypeError("expected text")
    if len(text) > limit or not text.isprintable():
        raise ValueError("expected printable text")
    return text


def _load(text: str) -> dict[str, object]:
    if len(text) > MAX_BYTES:
        raise ValueError("too long")
    try:
        loaded = json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    if not isinstance(loaded, dict):
        raise TypeError("expected an object")
    return loaded


_MISSING: Any = object()


def _take(
    fields: Mapping[str, object], name: str, check: Callable[[object], _Value], default: Any = _MISSING
) -> _Value:
    if name not in fields and default is not _MISSING:
        return cast(_Value, default)
    return check(fields[name]) if name in fields else _refuse(name)


def _refuse(name: str) -> Any:
    raise ValueError(f"{name} is missing")


def _list(check: Callable[[object], str], limit: int = 512) -> Callable[[object], tuple[str, ...]]:
    def check_all(value: object) -> tuple[str, ...]:
        if not isinstance(value, list) or len(value) > limit:
            raise TypeError("expected a list")
        return tuple(map(check, value))

    return check_all


def _name(value: object) -> str:
    return check_printable(value, 256)


def _line(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError("expected text")
    return "".join(letter if letter.isprintable() else " " for letter in value[:2000])


def _word(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError("expected an argument")
    if "\0" in value:
        raise ValueError("expected an argument without a zero byte")
    return value


def _identity(value: object) -> str:
    if not _CLIENT.fullmatch(check_printable(value)):
        raise ValueError("expected an id")
    return cast(str, value)


def _node(value: object) -> str:
    if not _NODE.fullmatch(check_printable(value, 1024)):
        raise ValueError("expected the name of a node")
    return cast(str, value)


def _names(value: object) -> Mapping[str, str]:
    if not isinstance(value, dict):
        raise TypeError("expected names of nodes")
    return {_node(old): _node(new) for old, new in value.items()}


def _count(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 1 << 31:
        raise TypeError("expected a number")
    return value


def _flag(value: object) -> bool:
    if not isinstance(value, bool):
        raise TypeError("expected true or false")
    return value


def _seconds(value: object) -> float:
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not abs(value) < 1e12:
        raise TypeError("expected seconds")
    return float(value)
