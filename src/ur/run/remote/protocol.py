"""Requests to a robot for its share of a run, and the answers: values, and each as JSON that is checked when read."""

from collections.abc import Mapping
from typing import Annotated, Literal

from msgspec import Meta

from ur.source.data_classes import dataclass, field, replace
from ur.source.foreign.json_values import convert_json, read_json, write_json

MAX_BYTES = 1 << 18
_MOST = 512
_Id = Annotated[str, Meta(pattern=r"^[0-9A-Za-z_-]{1,64}\Z")]
_Ids = Annotated[tuple[_Id, ...], Meta(max_length=_MOST)]
_Node = Annotated[str, Meta(pattern=r"^(/[A-Za-z][0-9A-Za-z_]*)+\Z", max_length=1024)]
_Nodes = Annotated[tuple[_Node, ...], Meta(max_length=_MOST)]
_Words = Annotated[tuple[Annotated[str, Meta(pattern=r"^[^\0]*\Z")], ...], Meta(max_length=_MOST)]
_Texts = Annotated[tuple[str, ...], Meta(max_length=_MOST)]


@dataclass(frozen=True, slots=True)
class Client:
    """A run on another computer that uses a robot's share of a run.

    `client` is the random id of that run (UR_CLIENT), `name` the host name of its computer, `machine` the identity of
    its user there (`ur.run.record.registry.describe_user`), `pid` its process, `nodes` the full names of its nodes.
    `detached`: it has no process and never unregisters. `since` is in s since the epoch, by the robot's clock.
    """

    client: _Id
    name: str
    machine: str
    pid: Annotated[int, Meta(ge=0, lt=1 << 31)]
    nodes: _Nodes = ()
    detached: bool = False
    since: Annotated[float, Meta(gt=-1e12, lt=1e12)] = 0.0


@dataclass(frozen=True, slots=True)
class ShareRequest:
    """A request for a share. `machine` is the robot's name in the launch file, `words` are arguments of `ur launch`.

    `words` follow its options. `nodes` are the full names of the share's nodes, without those that differ each time.
    `client` sends the request; `alive` are the ids of all running clients of its computer.
    """

    action: Literal["begin", "end"]
    machine: str
    words: _Words
    options: _Words = ()
    nodes: _Nodes = ()
    master_uri: str = ""
    host: str = ""
    client: Client | None = None
    alive: _Ids = ()


@dataclass(frozen=True, slots=True)
class Problem:
    """The reason why a share could not start: a message, a help line and the id of the rule.

    `place` is its file, line and column, '' for the arguments or the computer.
    """

    message: str
    help: str = ""
    rule: str = ""
    place: str = ""


@dataclass(frozen=True, slots=True)
class ShareAnswer:
    """The answer: `run` is the id of the share's run, '' without one; `found`: it was already running.

    `running`: nodes of other runs. `clients` are the names of the other computers that use these runs; `names` are new
    full names for nodes of this client whose names theirs have. After `end`, `ended` are the runs that have ended and
    `kept` those that continue for `clients`. `renamed_from` is the robot's old name under which the share ran before
    its restart.
    """

    run: str = ""
    found: bool = False
    running: _Texts = ()
    clients: _Texts = ()
    names: Mapping[_Node, _Node] = field(default_factory=dict)
    ended: _Texts = ()
    kept: _Texts = ()
    renamed_from: str = ""
    problem: Problem | None = None


def dump(value: ShareRequest | ShareAnswer) -> str:
    """Encode a value as one line of JSON."""
    return write_json(value)


def parse_request(text: str) -> ShareRequest:
    """Decode a request from another computer. Raises ValueError if it is invalid."""
    found = read_json(text, ShareRequest, MAX_BYTES)
    for each in (found.machine, found.master_uri, found.host):
        check_printable(each, 256)
    return found if found.client is None else replace(found, client=_check_client(found.client))


def parse_client(fields: object) -> Client:
    """Decode the description of a client. Raises ValueError."""
    return _check_client(convert_json(fields, Client))


def parse_answer(text: str) -> ShareAnswer:
    """Decode a robot's answer. Raises ValueError if it is invalid."""
    found = read_json(text, ShareAnswer, MAX_BYTES)
    for each in found.clients:
        check_printable(each, 256)
    running, ended, kept = (tuple(map(_clean, each)) for each in (found.running, found.ended, found.kept))
    problem = found.problem
    if problem is not None:
        problem = Problem(*map(_clean, (problem.message, problem.help, problem.rule, problem.place)))
    run, old = _clean(found.run), _clean(found.renamed_from)
    return replace(found, run=run, running=running, ended=ended, kept=kept, renamed_from=old, problem=problem)


def check_printable(text: object, limit: int = 64) -> str:
    """Return a name from another computer unchanged if it is printable. Raises ValueError or TypeError."""
    if not isinstance(text, str):
        raise TypeError("expected text")
    if len(text) > limit or not text.isprintable():
        raise ValueError("expected printable text")
    return text


def _check_client(client: Client) -> Client:
    check_printable(client.name, 256)
    check_printable(client.machine, 256)
    return client


def _clean(text: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in text[:2000])
