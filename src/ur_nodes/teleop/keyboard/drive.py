"""Velocities from keys: a step function without clock or terminal, and its settings.

The layout is that of teleop_twist_keyboard, plus the arrows. How a key's end is known differs by terminal:

- With release events (kitty protocol) the keys that are down add up. A lost connection releases nothing, so a
  terminal that has been silent for `LOST_AFTER` seconds counts as closed; the shell asks it for a sign of life.
- Without them a held key is a first press, a pause of 0.25 to 0.7 s, then repeats every 0.03 to 0.1 s. So a first
  press holds for as long as that pause may take, and a repeat for a fraction of it. The pause is learnt once seen.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

from ur_nodes.ports.parameters import Parameters
from ur_nodes.teleop.terminal.keys import KITTY_RELEASE_FLAGS, FocusLost, Key, KeyEvent, KittyFlags

FIRST_HOLD = 0.6
REPEAT_HOLD = 0.2
LOST_AFTER = 1.0
ZEROS = 3  # how often a stop is sent before silence: one message may be lost
_LONGEST_FIRST_HOLD = 1.0
_REPEAT_GAP = 0.15

DIRECTIONS: dict[str, tuple[int, int, int, int]] = {
    # key: x, y, z, yaw
    "i": (1, 0, 0, 0),
    "o": (1, 0, 0, -1),
    "j": (0, 0, 0, 1),
    "l": (0, 0, 0, -1),
    "u": (1, 0, 0, 1),
    ",": (-1, 0, 0, 0),
    ".": (-1, 0, 0, 1),
    "m": (-1, 0, 0, -1),
    "I": (1, 0, 0, 0),
    "O": (1, -1, 0, 0),
    "J": (0, 1, 0, 0),
    "L": (0, -1, 0, 0),
    "U": (1, 1, 0, 0),
    "<": (-1, 0, 0, 0),
    ">": (-1, -1, 0, 0),
    "M": (-1, 1, 0, 0),
    "t": (0, 0, 1, 0),
    "b": (0, 0, -1, 0),
    "up": (1, 0, 0, 0),
    "down": (-1, 0, 0, 0),
    "left": (0, 0, 0, 1),
    "right": (0, 0, 0, -1),
}
SPEED_KEYS: dict[str, tuple[float, float]] = {
    "q": (1.1, 1.1),
    "z": (0.9, 0.9),
    "w": (1.1, 1.0),
    "x": (0.9, 1.0),
    "e": (1.0, 1.1),
    "c": (1.0, 0.9),
}


class KeyVelocity(NamedTuple):
    """A velocity command: m/s forward, left, up; rad/s about z."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    yaw: float = 0.0


STILL = KeyVelocity()


@dataclass(frozen=True, slots=True)
class DriveSettings:
    """Speeds at the start and limits of the base (m/s, rad/s). `key_timeout` in s; 0 chooses holds as above."""

    speed: float
    turn: float
    speed_limit: float
    turn_limit: float
    key_timeout: float = 0.0


@dataclass(frozen=True, slots=True)
class DriveState:
    """The keys that drive now and since when. Times are those given to `step_drive`."""

    settings: DriveSettings
    speed: float
    turn: float
    held: tuple[str, ...] = ()
    reports_release: bool = False
    hold_until: float = 0.0
    received_at: float = 0.0
    last_key: str = ""
    last_key_at: float = -10.0
    pause_seen: float = 0.0
    first_hold: float = FIRST_HOLD
    zeros_left: int = 0
    note: str = ""
    quit: bool = False

    @property
    def moving(self) -> bool:
        """True while a key drives."""
        return bool(self.held)


def start_drive(settings: DriveSettings) -> DriveState:
    """Return the state of a robot at rest, speeds within the limits."""
    return DriveState(
        settings,
        min(settings.speed, settings.speed_limit),
        min(settings.turn, settings.turn_limit),
        first_hold=FIRST_HOLD,
    )


def use_settings(state: DriveState, settings: DriveSettings) -> DriveState:
    """Return the state with changed settings and their speeds, in place of those that keys have chosen."""
    fresh = start_drive(settings)
    return replace(state, settings=settings, speed=fresh.speed, turn=fresh.turn)


def step_drive(state: DriveState, event: KeyEvent | None, now: float) -> tuple[DriveState, KeyVelocity | None]:
    """Return the state after `event` (None: time has passed), and the velocity to publish, None for none.

    While a key drives every call returns its motion; after a stop the next `ZEROS` calls return zero, then silence.
    Call it for each event, and at the publishing rate with None.
    """
    before = state
    state = _apply(state, event, now)
    if state.held and (now - state.received_at > LOST_AFTER if state.reports_release else now > state.hold_until):
        state = replace(state, held=(), note="stopped: the terminal does not answer" if state.reports_release else "")
    if before.held and not state.held:
        state = replace(state, zeros_left=ZEROS)
    if state.held:
        return state, motion_of(state)
    if state.zeros_left:
        return replace(state, zeros_left=state.zeros_left - 1), STILL
    return state, None


def motion_of(state: DriveState) -> KeyVelocity:
    """Return the sum of the held keys, each axis limited to its speed."""
    if not state.held:
        return STILL
    total = [max(-1, min(1, sum(axis))) for axis in zip(*(DIRECTIONS[key] for key in state.held), strict=True)]
    return KeyVelocity(total[0] * state.speed, total[1] * state.speed, total[2] * state.speed, total[3] * state.turn)


def _apply(state: DriveState, event: KeyEvent | None, now: float) -> DriveState:
    if event is None:
        return state
    state = replace(state, received_at=now)
    if isinstance(event, KittyFlags):
        complete = event.flags & KITTY_RELEASE_FLAGS == KITTY_RELEASE_FLAGS
        return replace(state, reports_release=complete and not state.settings.key_timeout)
    if isinstance(event, FocusLost):
        return replace(state, held=())
    return _handle_key(state, event, now)


def _handle_key(state: DriveState, key: Key, now: float) -> DriveState:
    if key.action == "release":
        return replace(state, held=tuple(name for name in state.held if name != key.name))
    if key.ctrl:
        return replace(state, held=(), quit=state.quit or key.name in ("c", "d"))
    state = replace(state, note="")
    if key.name in SPEED_KEYS:
        return _change_speeds(state, *SPEED_KEYS[key.name])
    if key.name not in DIRECTIONS:
        return replace(state, held=())
    if state.reports_release:
        held = state.held if key.name in state.held else (*state.held, key.name)
        return replace(state, held=held)
    return _hold_for_a_while(state, key.name, now)


def _hold_for_a_while(state: DriveState, name: str, now: float) -> DriveState:
    gap = now - state.last_key_at if name == state.last_key else _LONGEST_FIRST_HOLD + 1.0
    repeats = gap < _REPEAT_GAP
    if repeats and state.pause_seen:  # first press, pause, repeat, repeat: now the pause is known
        state = replace(state, first_hold=max(REPEAT_HOLD, state.pause_seen + 0.1), pause_seen=0.0)
    elif not repeats:
        state = replace(state, pause_seen=gap if gap < _LONGEST_FIRST_HOLD else 0.0)
    hold = state.settings.key_timeout or (REPEAT_HOLD if repeats else state.first_hold)
    return replace(state, held=(name,), hold_until=now + hold, last_key=name, last_key_at=now)


def _change_speeds(state: DriveState, speed_factor: float, turn_factor: float) -> DriveState:
    limits = state.settings
    speed, turn = state.speed * speed_factor, state.turn * turn_factor
    over = [
        text
        for text, is_over in (
            ("forward speed is at its limit", speed > limits.speed_limit + 1e-9),
            ("turning speed is at its limit", turn > limits.turn_limit + 1e-9),
        )
        if is_over
    ]
    return replace(
        state,
        speed=min(max(speed, 0.01), limits.speed_limit),
        turn=min(max(turn, 0.01), limits.turn_limit),
        note="; ".join(over),
    )


def read_settings(parameters: Parameters) -> tuple[DriveSettings, float]:
    """Read the settings of a node, and its commands per second. Raises UserError."""
    speed_limit = parameters.limit("speed_limit", 1000.0, minimum=0.0, live="greatest speed, m/s")
    turn_limit = parameters.limit("turn_limit", 1000.0, minimum=0.0, live="greatest turn, rad/s")
    settings = DriveSettings(
        speed=parameters.number("speed", min(0.5, speed_limit), minimum=0.0, live="speed of a key, m/s"),
        turn=parameters.number("turn", min(1.0, turn_limit), minimum=0.0, live="turn of a key, rad/s"),
        speed_limit=speed_limit,
        turn_limit=turn_limit,
        key_timeout=parameters.number("key_timeout", 0.0, minimum=0.0, maximum=10.0),
    )
    rate = parameters.number("repeat_rate", 30.0, minimum=0.0, maximum=200.0)
    return settings, max(rate, 10.0) if rate else 30.0  # the mux ignores commands that are older than 0.15 s
