"""The settings of the mux, from parameters."""

import math
from dataclasses import dataclass, replace

from ur.robot.base import BRAKE_AFTER, Base, load_base
from ur.source.project import launch_library
from ur_nodes.motion.challenge.freshness import FRESHNESS
from ur_nodes.motion.lease.text import LEASE_TIMEOUT
from ur_nodes.motion.mux_events import MuxSettings, Source
from ur_nodes.motion.ramp import axes_of, lateral_axis
from ur_nodes.motion.sources import read_locks, read_sources
from ur_nodes.ports.parameters import Parameters

STOPPED = "emergency_stop"  # on the parameter server, so that an emergency outlives the process
LIMIT = "speed_limit_percent"  # likewise
LEAST_LIMIT = 5.0  # percent
FOREIGN = "program"  # the source whose topic is taken over
_FOREIGN_PRIORITY = 5
_FOREIGN_TIMEOUT = 0.2  # s
_SLACK = 0.02  # s


@dataclass(frozen=True, slots=True)
class MuxNodeSettings:
    """Settings of the mux, and its state at the start: `stopped`, and the `share` of the base's speeds.

    `challenge_rate` is in Hz, `freshness` and `lease_timeout` in s. `slowed` is a line for users about a base that is
    faster than its lidar sees.
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
    base, slowed = _slow_to_sight(base)
    forward, turn = axes_of(base.limits)
    sources = read_sources(own.any("topics"), own.name("topics"))
    return MuxNodeSettings(
        base,
        MuxSettings(
            (*sources, *_read_foreign(own, sources)),
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
        obstacle_stop=own.boolean("obstacle_stop", False),
        sonars=own.boolean("use_sonars", True),
        challenge_rate=own.number("challenge_rate", 50.0, minimum=20.0, maximum=100.0),
        freshness=own.number("freshness", FRESHNESS, minimum=0.05, maximum=0.5),
        lease_timeout=own.number("lease_timeout", LEASE_TIMEOUT, minimum=1.0, maximum=60.0),
        slowed=slowed,
    )


def _slow_to_sight(base: Base) -> tuple[Base, str]:
    """Return a base that rests within what its lidar sees, and a line about it if it is slower than its file says."""
    if base.lidar is None:
        return base, ""
    sight = base.lidar.range_max - max(math.hypot(x, y) for x, y in base.footprint)
    limits = base.limits.within_sight(sight)
    if limits == base.limits:
        return base, ""
    line = f"{base.name} drives at most {limits.velocity:.2f} m/s: from {base.limits.velocity:g} m/s it rests within"
    return replace(base, limits=limits), f"{line} {base.limits.way_to_rest:.1f} m, and its lidar sees {sight:.1f} m"


def _read_foreign(own: Parameters, sources: tuple[Source, ...]) -> tuple[Source, ...]:
    """Read the source of the commands that third-party programs send to a base, whose topic the mux takes over."""
    topic = own.text("takes_over", "")
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
