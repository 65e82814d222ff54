"""The settings of the mux, from parameters with twist_mux's names: limits, sources and locks.

A source has `name`, `topic`, `timeout` and `priority`; on ROS 2 they are mappings by name. This mux has two more:
`zeros_hold: true` for sources that are silent when idle and whose zeros are a command, and `avoids_obstacles: true` for
programs that read sensors themselves, whose commands the obstacle stop lets pass.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NoReturn

from ur.robot.base import BRAKE_AFTER, Base, load_base
from ur.source.diagnostic import UserError, error
from ur.source.project import launch_library
from ur.source.suggest import did_you_mean
from ur_nodes.motion.challenge.freshness import FRESHNESS
from ur_nodes.motion.lease.text import LEASE_TIMEOUT
from ur_nodes.motion.mux_events import IDLE, Lock, MuxSettings, Source
from ur_nodes.motion.ramp import axes_of, lateral_axis
from ur_nodes.ports.parameters import Parameters

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


STOPPED = "emergency_stop"  # on the parameter server, so that an emergency outlives the process
LIMIT = "speed_limit_percent"  # likewise
LEAST_LIMIT = 5.0  # percent
BESIDE = "cmd_vel_nav2"  # the topic that is taken over where there are no other sources
FOREIGN = "program"  # the source whose topic is taken over
_FOREIGN_PRIORITY = 5
_FOREIGN_TIMEOUT = 0.2  # s
_SLACK = 0.02  # s


@dataclass(frozen=True, slots=True)
class MuxNodeSettings:
    """Settings of the mux, and its state at the start: `stopped`, and the `share` of the base's speeds.

    `challenge_rate` is in Hz, `freshness` and `lease_timeout` in s. `slowed` is a line for users about a base that is
    faster than it sees.
    """

    base: Base
    mux: MuxSettings
    stopped: bool
    share: float
    obstacle_stop: bool
    sonars: bool
    challenge_rate: float
    freshness: float
    lease_timeout: float
    slowed: str = ""


def read_settings(own: Parameters) -> MuxNodeSettings:
    """Raises UserError."""
    base = load_base(own.text("package", str(launch_library())), own.text("base"), own.text("variant", ""))
    sonars = own.boolean("use_sonars", True)
    base, slowed = slow_to_sight(base, sonars=sonars)
    forward, turn = axes_of(base.limits)
    alone = not own.has("topics")  # without sources of its own it is the obstacle stop of one program
    sources = () if alone else read_sources(own.any("topics"), own.name("topics"))
    return MuxNodeSettings(
        base,
        MuxSettings(
            (*sources, *_read_foreign(own, sources, BESIDE if alone else "")),
            forward,
            turn,
            read_locks(own.any("locks", []), own.name("locks")),
            period=1.0 / own.number("rate", 50.0, minimum=10.0, maximum=100.0),
            stop_time=own.number("stop_time", 0.3, minimum=0.1, maximum=2.0),
            forgets=base.limits.command_age + _SLACK,
            lag=own.number("lag", base.limits.lag, minimum=0.0, maximum=0.5),
            left=lateral_axis(base.limits),
            brake_after=BRAKE_AFTER if base.limits.fast else None,
        ),
        stopped=own.any(STOPPED, False) is True,
        share=read_limit(own) / 100.0,
        obstacle_stop=own.boolean("obstacle_stop", alone),
        sonars=sonars,
        challenge_rate=own.number("challenge_rate", 50.0, minimum=20.0, maximum=100.0),
        freshness=own.number("freshness", FRESHNESS, minimum=0.05, maximum=0.5),
        lease_timeout=own.number("lease_timeout", LEASE_TIMEOUT, minimum=1.0, maximum=60.0),
        slowed=slowed,
    )


def slow_to_sight(base: Base, *, sonars: bool = True) -> tuple[Base, str]:
    """Return a base that rests within what its lidar sees, or its sonars where it has none.

    And a line about it if it is slower than its file says.
    """
    eyes = base.lidar or (base.sonars if sonars else None)
    if eyes is None:
        return base, ""
    sight = eyes.range_max - max(math.hypot(x, y) for x, y in base.footprint)
    limits = base.limits.within_sight(sight)
    if limits == base.limits:
        return base, ""
    line = f"{base.name} drives at most {limits.velocity:.2f} m/s: from {base.limits.velocity:g} m/s it rests within"
    seen = f"its {'lidar sees' if base.lidar else 'sonars see'} {sight:.1f} m"
    return replace(base, limits=limits), f"{line} {base.limits.way_to_rest:.1f} m, and {seen}"


def _read_foreign(own: Parameters, sources: tuple[Source, ...], default: str) -> tuple[Source, ...]:
    """Read the source of the commands that third-party programs send to a base, whose topic the mux takes over."""
    topic = own.text("takes_over", default)
    if topic in (source.topic for source in sources) or FOREIGN in (source.name for source in sources):
        own.fail("takes_over", topic, f"a topic that is none of the sources, and no source named {FOREIGN}")
    return (Source(FOREIGN, topic, _FOREIGN_PRIORITY, _FOREIGN_TIMEOUT, foreign=True),) if topic else ()


def read_limit(own: Parameters) -> float:
    """Return the percentage of the base's speeds that is allowed. Raises UserError."""
    return own.number(LIMIT, 100.0, minimum=LEAST_LIMIT, maximum=100.0, live="share of the base's speeds, percent")


def read_share(percent: object) -> float | None:
    """Return the share of a percentage (0: all); None if invalid."""
    if not isinstance(percent, (int, float)) or isinstance(percent, bool):
        return None
    if percent == 0.0:
        return 1.0
    return float(percent) / 100.0 if LEAST_LIMIT <= percent <= 100.0 else None
