"""Acceptance of velocity commands that carry no proof of their age: plain Twist, by its rhythm.

Commands that a network has held back arrive in clusters, and after a gap. So a publisher drives only while its commands
keep arriving one by one:

- A publisher that has been silent for longer than the source's timeout is on *probation*: its commands are ignored
  until `PROOF` of them in a row have arrived, each at least `TOO_CLOSE` and at most the timeout after the one before.
- Two that arrive closer together than `TOO_CLOSE` begin the probation again. Where `stamps` show the age of commands,
  which a thread that pauses may deliver together, the second one takes back one of the row instead.
- A publisher that drives is put on probation again by a cluster: `CLUSTER` commands within `TOO_CLOSE` after a silence
  of `HELD_BACK` or more.

So a single command never drives, and neither does a publisher that is slower than its source's timeout allows. Each
publisher proves its own rhythm. These rules are a filter, not a proof: a commander that can should answer challenges
(see `freshness`). All functions are pure; `now` is in seconds of a steady clock.
"""

import math
from dataclasses import dataclass, replace

PROOF = 5
TOO_CLOSE = 0.005  # s
CLUSTER = 4
HELD_BACK = 0.08  # s
_ADVISED = 10  # Hz, at which a program drives although its commands jitter
_MOST = round(1.0 / TOO_CLOSE)  # Hz
_SHORT = 3.0  # s: after a longer gap, commands are counted anew
_UNSTEADY = 2.0  # s on probation, after which a publisher without gaps is reported


@dataclass(frozen=True, slots=True)
class Probation:
    """A publisher of plain commands to a source whose commands age within `timeout` (s).

    `count` is how many have arrived in a row as they should, at most PROOF: then the publisher is accepted.
    `cluster` is how many have arrived together right after the last silence. `seen` have arrived from `began` on,
    while the publisher was not accepted.
    """

    timeout: float
    count: int = 0
    at: float = -math.inf
    silence_ended_at: float = -math.inf
    cluster: int = 0
    wants_motion: bool = False
    reported: bool = False
    seen: int = 0
    began: float = -math.inf

    @property
    def rate(self) -> float:
        """Return the rate (Hz) of the commands on probation; 0.0 after a single one."""
        return (self.seen - 1) / (self.at - self.began) if self.at > self.began else 0.0

    @property
    def accepted(self) -> bool:
        """Return whether the publisher's commands are accepted."""
        return self.count >= PROOF


def step_probation(state: Probation, now: float, *, motion: bool, aged: bool = False) -> Probation:
    """Return the state after a command at `now` with or without motion; `aged`: its age is known.

    The command is accepted if `accepted` is set.
    """
    gap = now - state.at
    again = state.accepted or not 0.0 <= gap <= _SHORT
    state = replace(state, seen=1 if again else state.seen + 1, began=now if again else state.began)
    if gap < 0.0 or gap > state.timeout:
        return replace(
            state, count=1, at=now, silence_ended_at=now, cluster=1, wants_motion=motion, reported=state.reported
        )
    wants = state.wants_motion or motion
    if gap >= HELD_BACK:
        state = replace(state, silence_ended_at=now, cluster=0)
    cluster = state.cluster + 1 if now - state.silence_ended_at < TOO_CLOSE else 0
    state = replace(state, at=now, cluster=cluster, wants_motion=wants)
    if state.accepted:
        return replace(state, count=0) if cluster >= CLUSTER else state
    if gap < TOO_CLOSE:
        return replace(state, count=max(1, state.count - 1) if aged else 1)
    count = state.count + 1
    return replace(state, count=count, reported=state.reported and count < PROOF)


def restart_proof(state: Probation) -> Probation:
    """Return the state of a publisher whose earlier commands do not count; the next one is the first in a row."""
    return replace(state, count=0)


def too_slow(state: Probation, now: float) -> tuple[Probation, bool]:
    """Return whether the publisher requests motion and stays on probation; reported once until it drives."""
    if state.reported or state.accepted or not state.wants_motion:
        return state, False
    slow = now - state.at > (state.timeout if state.seen > 1 else _SHORT)
    if not slow and (state.seen == 1 or now - state.began <= _UNSTEADY):
        return state, False
    return replace(state, reported=True), True


def describe_slow(state: Probation, kind: str) -> str:
    """Describe what a publisher of commands of a kind does, and what would be accepted."""
    needed = rate_needed(state.timeout)
    if not state.rate:
        return f"published a single {kind}; the robot drives at {needed} Hz or more"
    if state.rate < needed:
        return f"publishes {kind} at {round(state.rate, 1):g} Hz; the robot drives at {needed} Hz or more"
    return f"publishes {kind} at {state.rate:.0f} Hz, unsteadily; the robot drives at a steady {needed} to {_MOST} Hz"


def rate_needed(timeout: float) -> int:
    """The lowest whole rate (Hz) at which plain commands that jitter drive."""
    return max(_ADVISED, math.floor(1.0 / timeout) + 1)


@dataclass(frozen=True, slots=True)
class LockRelease:
    """A publisher of a lock whose `false` would let others drive. `timeout` (s) is the lock's, 0 for none."""

    timeout: float
    rhythm: Probation = Probation(1.0)


def step_lock_release(state: LockRelease, now: float, *, locked: bool, new: bool) -> tuple[LockRelease, bool]:
    """Return the state after a message of a lock at `now`, and whether to apply it. `new`: the first of its publisher.

    `true` is applied at any age. `false` is applied when it is the first message of a new publisher
    (as of `rostopic pub`), and when it is repeated with a steady rhythm like plain commands. A publisher that connects
    again after a cut may send old commands again, so its name is remembered.
    """
    if locked:
        return LockRelease(state.timeout), True
    limit = min(1.0, state.timeout) if state.timeout > 0.0 else 1.0
    rhythm = step_probation(replace(state.rhythm, timeout=limit), now, motion=True)
    if new:
        rhythm = replace(rhythm, count=PROOF)
    return LockRelease(state.timeout, rhythm), rhythm.accepted
