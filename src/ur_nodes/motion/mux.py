"""Selection of one stream of velocity commands out of many, as a step function without clock or topics.

A source *drives* while its newest command is not older than its `timeout` and it has asked for motion within that time;
with `zeros_hold` zeros count as driving too. Of the sources that drive, the one with the highest priority is *active*.
Its commands are followed within the limits of the base, and never faster than the robot can still stop from in time:
when the newest command is `age` old, the speed is at most

    slow_down * (stop_time - lag - age)

where `lag` is the delay between an output and the wheels. So the robot is at rest `stop_time` after the last command
that arrived, at any speed and with any timeout. A base that cannot brake so hard has `brake_after`: from a motion that
takes longer than `stop_time` to stop, its wheels brake that long after the last command, and all the way. Before
obstacles the guard slows and stops it as well (`ur_nodes.motion.obstacle_stop.guard`).

While something is active or the robot moves there is an output every
`period`, while it brakes every `brake_period`; then `zeros` zeros, then silence. A base that has received nothing for
`forgets` s has stopped by itself: a mux that was suspended goes on from zero, and not from its last output.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ur_nodes.motion.mux_events import (
    IDLE,
    STILL,
    EmergencyReleased,
    EmergencyStopped,
    Event,
    LockMessage,
    MuxSettings,
    Source,
    SpeedLimited,
    Velocity,
    VelocityCommand,
    slow_to,
)
from ur_nodes.motion.obstacle_stop.guard import Guard, GuardVerdict
from ur_nodes.motion.ramp import Axis, approach

_SOON = 1e-6  # s: outputs that are this near to being due are due


class ReceivedCommand(NamedTuple):
    """The newest command of a source, its time, and the time of the source's last motion."""

    velocity: Velocity = STILL
    at: float = -math.inf
    moved_at: float = -math.inf
    barred: bool = False


class MuxState(NamedTuple):
    """State of the mux; a tuple, as each step copies it. Times are those given to `step`.

    `next_at` is when to call it next, infinite when silent. `share` of the base's speeds is allowed. `verdict` is that
    of the `guard` on the newest output: None while nothing drives, or what drives is not guarded.
    """

    settings: MuxSettings
    received: tuple[ReceivedCommand, ...]
    locks: tuple[tuple[bool, float], ...]
    stopped: bool = False
    active: int | None = None
    output: Velocity = STILL
    output_at: float = -math.inf
    zeros_left: int = 0
    next_at: float = math.inf
    now: float = -math.inf
    share: float = 1.0
    guard: Guard | None = None
    verdict: GuardVerdict | None = None

    @property
    def wanted(self) -> Velocity:
        """The newest command of the source that is being followed; zero for none."""
        return STILL if self.active is None else self.received[self.active].velocity

    @property
    def active_name(self) -> str:
        """The name of the source that is being followed, or IDLE."""
        return IDLE if self.active is None else self.settings.sources[self.active].name


def start_mux(settings: MuxSettings, *, stopped: bool = False, share: float = 1.0) -> MuxState:
    """Return the initial state: silent, no input yet; `share` of the base's speeds is allowed."""
    return MuxState(
        settings,
        tuple(ReceivedCommand() for _ in settings.sources),
        tuple((False, -math.inf) for _ in settings.locks),
        stopped,
        share=share,
    )


def step(state: MuxState, event: Event | None, now: float) -> tuple[MuxState, Velocity | None]:
    """Return the state after `event` (None: time has passed) at `now`, and the velocity to send; None for nothing.

    Call it for each event, and without one at `state.next_at`. When time goes back, all commands are dropped.
    """
    if now < state.now:
        state = _forget(state, now)
    state = _apply(state, event, now)
    was_silent = math.isinf(state.next_at)
    active = _choose(state, now)
    if active != state.active:
        state = state._replace(active=active)
    if was_silent and state.active is None and state.output.still:
        return state, None
    slack = -_SOON if event is None else state.settings.brake_period  # an event may be one of several before an output
    if not (was_silent or isinstance(event, EmergencyStopped) or now >= state.next_at + slack):
        return state, None
    return _send(state, now)


def _forget(state: MuxState, now: float) -> MuxState:
    """Drop inputs from before time was set back, as their age is unknown."""
    fresh = start_mux(state.settings, stopped=state.stopped, share=state.share)._replace(guard=state.guard)
    if state.output.still and math.isinf(state.next_at):
        return fresh
    return fresh._replace(output=state.output, output_at=now, zeros_left=state.settings.zeros, next_at=now)


def _apply(state: MuxState, event: Event | None, now: float) -> MuxState:
    if isinstance(event, VelocityCommand):
        timeout = state.settings.sources[event.source].timeout
        received = list(state.received)
        at = now if event.at is None else min(now, event.at)
        velocity = event.velocity
        if velocity.left and not state.settings.left.speed:
            velocity = Velocity(velocity.forward, velocity.turn)  # its wheels do not roll sideways
        received[event.source] = _receive(received[event.source], velocity, timeout, at)
        return state._replace(now=now, received=tuple(received))
    if isinstance(event, LockMessage):
        locks = list(state.locks)
        locks[event.lock] = (event.locked, now)
        return state._replace(now=now, locks=tuple(locks))
    if isinstance(event, EmergencyStopped):
        return state._replace(now=now, stopped=True)
    if isinstance(event, SpeedLimited):
        share = max(0.0, min(1.0, event.share)) if math.isfinite(event.share) else state.share
        return state._replace(now=now, share=share)
    if isinstance(event, EmergencyReleased) and state.stopped:
        pairs = zip(state.settings.sources, state.received, strict=True)
        barred = tuple(each._replace(barred=now - each.moved_at <= source.timeout) for source, each in pairs)
        return state._replace(now=now, stopped=False, received=barred)
    return state._replace(now=now)


def _receive(before: ReceivedCommand, velocity: Velocity, timeout: float, at: float) -> ReceivedCommand:
    if at < before.at:
        return before
    if velocity.still or not velocity.finite:
        velocity = STILL  # what is too slow to count as motion must not be sent on as motion either
    paused = velocity.still or at - before.at > timeout
    moved_at = before.moved_at if velocity.still else at
    return ReceivedCommand(velocity, at, moved_at, before.barred and not paused)


def _choose(state: MuxState, now: float) -> int | None:
    """Return the index of the source to follow."""
    if state.stopped:
        return None
    locks = zip(state.settings.locks, state.locks, strict=True)
    locked = (lock.priority for lock, (on, at) in locks if on or 0.0 < lock.timeout < now - at)
    floor = max(locked, default=None)
    sources = state.settings.sources
    drive = [
        index
        for index, (source, received) in enumerate(zip(sources, state.received, strict=True))
        if _drives(source, received, now) and (floor is None or source.priority >= floor)
    ]
    return max(drive, key=lambda index: (sources[index].priority, index == state.active), default=None)


def _drives(source: Source, received: ReceivedCommand, now: float) -> bool:
    since = received.at if source.zeros_hold else received.moved_at
    return not received.barred and now - received.at <= source.timeout and now - since <= source.timeout


def _send(state: MuxState, now: float) -> tuple[MuxState, Velocity]:
    settings = state.settings
    if now - state.output_at > settings.forgets:
        state = state._replace(output=STILL)
    received = ReceivedCommand() if state.active is None else state.received[state.active]
    wanted = slow_to(received.velocity, state.share, settings)
    left = settings.stop_time - settings.lag - (now - received.at)  # s, until the robot has to be at rest
    seconds = max(0.0, min(settings.period, now - state.output_at))
    left_to_brake = left - settings.brake_period
    output = _approach(state.output, wanted, settings, left_to_brake, seconds)
    guarded = state.active is not None and not settings.sources[state.active].avoids_obstacles
    verdict = state.guard.permit(output.forward, output.turn, now, output.left) if state.guard and guarded else None
    if verdict is not None and verdict.cause is not None:
        wanted = Velocity(verdict.forward, verdict.turn, verdict.left)
        output = _approach(state.output, wanted, settings, left_to_brake, seconds)
    rests = state.active is None and output == STILL
    zeros_left = (state.zeros_left if state.output == STILL else settings.zeros) - 1 if rests else settings.zeros
    if rests:
        next_at = now + settings.period if zeros_left > 0 else math.inf
    else:
        next_at = _next_output(settings, output, wanted, left, now)
    state = state._replace(output=output, output_at=now, zeros_left=zeros_left, verdict=verdict, next_at=next_at)
    return state, output


def _approach(before: Velocity, target: Velocity, settings: MuxSettings, left: float, seconds: float) -> Velocity:
    aside = before.left or target.left
    more = settings.braking_beyond_stop_time
    forward, turn, to_left = settings.forward, settings.turn, settings.left
    return Velocity(
        _follow(before.forward, target.forward, forward, left + more(target.forward, forward), seconds),
        _follow(before.turn, target.turn, turn, left + more(target.turn, turn), seconds),
        _follow(before.left, target.left, to_left, left + more(target.left, to_left), seconds) if aside else 0.0,
    )


def _follow(value: float, target: float, axis: Axis, left: float, seconds: float) -> float:
    """Return `value` after `seconds` towards `target`, limited to what can be braked in `left` s."""
    fastest = axis.slow_down * max(0.0, left)
    return approach(value, max(-fastest, min(fastest, target)), axis, seconds) + 0.0  # -0.0 would puzzle people


def _next_output(settings: MuxSettings, output: Velocity, target: Velocity, left: float, now: float) -> float:
    if any(abs(value) > abs(wanted) for value, wanted in zip(output, target, strict=True)):
        return now + settings.brake_period
    axes = settings.forward, settings.turn, settings.left
    brake_in = left + min(
        settings.braking_beyond_stop_time(wanted, axis) - abs(value) / axis.slow_down
        for value, wanted, axis in zip(output, target, axes, strict=True)
    )  # s: then the speed is too high for the age of the command
    return now + max(settings.brake_period, min(settings.period, brake_in))
