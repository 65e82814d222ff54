"""The outcome of a replay in lock step: what nodes reported, when it was recorded and now."""

from __future__ import annotations

from collections.abc import Iterable

from ur.recordings.lock_step import Outcome
from ur.recordings.message_types import full_type_name
from ur.source.diagnostic import UserError
from ur_nodes.lock_step.bus import StepBus
from ur_nodes.ports.actions import GoalState
from ur_nodes.ports.raw import FindReader

_STATES = (str, bool)


def judge(bus: StepBus, tested: frozenset[str], find_reader: FindReader) -> tuple[Outcome, Outcome]:
    """The outcome that was recorded, and that of the nodes on a bus that has come to its end."""
    readers = [
        found
        for topic, entry in bus.topics.items()
        for each in entry.offers
        if each.sender in tested and isinstance(each.kind, type) and each.kind in (*_STATES, GoalState)
        if (found := find_reader(topic, each.kind)) is not None
    ]
    sent: list[tuple[str, object]] = []
    for message in bus.recorded:
        topic = message.topic
        for reader in readers:
            if reader.topic != topic.name or full_type_name(reader.type_name) != full_type_name(topic.type_name):
                continue
            try:
                sent.append((topic.name, reader.read(message.data)))
            except (ValueError, UserError):
                continue
    return _collect(sent), _collect((each.topic, each.value) for each in bus.outputs)


def _collect(sent: Iterable[tuple[str, object]]) -> Outcome:
    found = Outcome()
    ended: set[str] = set()
    for topic, value in sent:
        if isinstance(value, GoalState):
            if not value.open and value.id not in ended:
                ended.add(value.id)
                found.endings.append((value.state, value.text))
        elif isinstance(value, _STATES):
            values = found.states.setdefault(topic, [])
            if not values or values[-1] != str(value):
                values.append(str(value))
    return found
