"""The sources and locks of a mux, from parameters with twist_mux's names: `name`, `topic`, `timeout`, `priority`.

On ROS 2 they are mappings by name. This mux has two more: `zeros_hold: true` for sources that are silent when idle and
whose zeros are a command, and `avoids_obstacles: true` for programs that read sensors themselves, whose commands the
obstacle stop lets pass.
"""

import math
from collections.abc import Mapping
from typing import NoReturn

from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean
from ur_nodes.motion.mux_events import IDLE, Lock, Source

_LONGEST = 1.0  # s: what is older than that is no command any more


def read_sources(value: object, where: str) -> tuple[Source, ...]:
    """Sources from a plain value (a list of mappings); `where` is the parameter's name, for errors.

    Raises UserError: not such a list, none at all, a key missing, unknown or of the wrong kind, a name given twice, or
    a timeout that is not above 0 and at most 1 s.
    """
    items = [_Item(item, f"{where}, item {n}") for n, item in enumerate(_list(value, where), start=1)]
    if not items:
        _fail(where, "no sources, expected at least one")
    sources = tuple(
        Source(
            item.text("name"),
            item.text("topic"),
            item.priority(),
            item.timeout(minimum=0.01, maximum=_LONGEST),
            item.flag("zeros_hold"),
            item.flag("avoids_obstacles"),
        )
        for item in items
    )
    for item in items:
        item.finish()
    _require_unique_names([source.name for source in sources], where)
    return sources


def read_locks(value: object, where: str) -> tuple[Lock, ...]:
    """Locks, likewise; none is fine. A timeout of 0 means that the lock does not age."""
    items = [_Item(item, f"{where}, item {n}") for n, item in enumerate(_list(value, where), start=1)]
    locks = tuple(Lock(i.text("name"), i.text("topic"), i.priority(), i.timeout(minimum=0.0)) for i in items)
    for item in items:
        item.finish()
    _require_unique_names([lock.name for lock in locks], where)
    return locks


class _Item:
    """One mapping of the list, read key by key."""

    def __init__(self, value: object, where: str) -> None:
        if not isinstance(value, Mapping):
            _fail(where, f"{value!r}, expected a mapping with name, topic, timeout and priority")
        self._value = value
        self._where = where
        self._asked: set[str] = set()

    def text(self, key: str) -> str:
        value = self._get(key, "a text")
        if not isinstance(value, str) or not value:
            _fail(self._where, f"{key}: {value!r}, expected a text")
        return value

    def priority(self) -> int:
        value = self._get("priority", "a whole number from 0 to 255")
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= 255:
            _fail(self._where, f"priority: {value!r}, expected a whole number from 0 to 255")
        return value

    def timeout(self, minimum: float, maximum: float = math.inf) -> float:
        limits = f"from {minimum:g} to {maximum:g}" if math.isfinite(maximum) else f"of at least {minimum:g}"
        expected = f"a number of seconds {limits}"
        value = self._get("timeout", expected)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not minimum <= value <= maximum:
            _fail(self._where, f"timeout: {value!r}, expected {expected}")
        return float(value)

    def flag(self, key: str) -> bool:
        self._asked.add(key)
        value = self._value.get(key, False)
        if not isinstance(value, bool):
            _fail(self._where, f"{key}: {value!r}, expected true or false")
        return value

    def finish(self) -> None:
        for key in self._value:
            if key not in (*self._asked, "short_desc"):  # the comment that yujin's cmd_vel_mux has
                near = did_you_mean(str(key), self._asked)
                known = f"known here: {', '.join(sorted(self._asked))}"
                _fail(self._where, f"{key} is not known", f"did you mean {near!r}?" if near else known)

    def _get(self, key: str, expected: str) -> object:
        self._asked.add(key)
        if key not in self._value:
            _fail(self._where, f"{key} is missing, expected {expected}")
        return self._value[key]


def _list(value: object, where: str) -> list[object]:
    if isinstance(value, Mapping):  # the form of twist_mux on ROS 2, which has no lists of mappings
        return [{"name": name, **each} if isinstance(each, Mapping) else each for name, each in value.items()]
    if not isinstance(value, list):
        _fail(where, f"{value!r}, expected a list of mappings with name, topic, timeout and priority")
    return value


def _require_unique_names(names: list[str], where: str) -> None:
    for name in names:
        if names.count(name) > 1 or name == IDLE:
            reason = (
                f"means that nothing drives, expected another name than {IDLE!r}" if name == IDLE else "is given twice"
            )
            _fail(where, f"the name {name!r} {reason}")


def _fail(where: str, problem: str, help: str | None = None) -> NoReturn:
    raise UserError(error(f"parameter {where}: {problem}", rule="bad-parameter", help=help))
