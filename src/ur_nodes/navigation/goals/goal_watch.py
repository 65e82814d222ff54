"""The lease and the challenges of the mux, as `move_base` uses them: which goals to accept, pursue, hold and cancel."""

import json
from collections.abc import Callable

from ur_nodes.motion.challenge.link import ChallengeLink
from ur_nodes.motion.lease.text import LEASE_TIMEOUT, Lease, read_lease
from ur_nodes.navigation.goals.attendance import (
    Act,
    Attendance,
    AttendanceSettings,
    GoalVerdict,
    attend_goal,
    refuse_goal,
    step_attendance,
)
from ur_nodes.navigation.goals.goal_claim import REMEMBERED, ReceivedChallenges, note_challenge, read_claim
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality

_LONGEST_TEXT = 300


class GoalWatch:
    """Decides about one goal at a time, from the messages of the mux.

    Publishes `~hold` (std_msgs/String, latched, JSON): `goal`, the id of the goal that is held, `state`: `held`
    or empty when none is, and `text`.
    """

    def __init__(
        self, node: Node, mux: str, settings: AttendanceSettings, on_mux: Callable[[], None] = lambda: None
    ) -> None:
        """`mux` is the name of the mux's node; `on_mux` is called after its first challenge.

        The goal is held while the robot is lost, as well.
        """
        self._node = node
        self._on_mux = on_mux
        self._settings = settings
        self._lease: Lease | None = None
        self._lost = ""
        self._challenges = ReceivedChallenges()
        self._goal = ""
        self._attendance = Attendance()
        self._reported = True
        self._shown: tuple[str, Act] | None = None
        self._hold = node.publish("~hold", str, Quality.LATCHED)
        self._publish_hold("", GoalVerdict(Act.DRIVE))
        self.link = ChallengeLink(node, mux, self._on_challenge)
        node.subscribe(f"{mux}/lease", str, self._on_lease, Quality.LATCHED)
        node.subscribe("amcl/lost", str, self._on_lost, Quality.LATCHED)

    def accept(self, goal_id: str) -> str:
        """Accept a goal, or return why it is refused and change nothing."""
        claim, now = read_claim(goal_id), self._node.steady()
        refusal = refuse_goal(claim, self._lease, self._challenges, now)
        if not refusal:
            self._goal, self._attendance = goal_id, attend_goal(claim, self._challenges, now)
            self._reported = False
        return refusal

    def finish(self) -> None:
        """Drop the goal after its end."""
        self._goal = ""
        self._publish_hold("", GoalVerdict(Act.DRIVE))

    def judge(self) -> GoalVerdict:
        """Decide what to do with the goal now, and publish it."""
        now = self._node.steady()
        silence = self._challenges.silence(now)
        self._attendance, verdict = step_attendance(self._attendance, self._lease, silence, self._settings, now)
        if not self._reported and self._lease is not None and self._attendance.unattended:
            self._reported = True
            self._node.log.info(
                "the goal is unattended: no client holds the lease of the mux, so nothing holds the goal"
            )
        if self._lost and verdict.act is Act.DRIVE:
            verdict = GoalVerdict(Act.HOLD, f"held: {self._lost}")
        self._publish_hold(self._goal, verdict)
        return verdict

    def _publish_hold(self, goal: str, verdict: GoalVerdict) -> None:
        """Publish when the state changes; the text grows by seconds and is in the goal's status."""
        held = verdict.act is Act.HOLD
        shown = (goal, verdict.act) if held else ("", Act.DRIVE)
        if shown == self._shown:
            return
        self._shown = shown
        state = verdict.act.value if held else ""
        text = verdict.text if held else ""
        self._hold.send(json.dumps({"goal": shown[0], "state": state, "text": text}))

    def _on_challenge(self) -> None:
        value = self.link.newest(REMEMBERED)
        if value is not None:
            first = self._challenges.newest_at is None
            self._challenges = note_challenge(self._challenges, value, self._node.steady())
            if first:
                self._on_mux()

    def _on_lease(self, text: str) -> None:
        lease = read_lease(text)
        if lease is None:
            self._node.log.warn("the lease of the mux cannot be read, expected its JSON; ignored", every=10.0)
        else:
            self._lease = lease

    def _on_lost(self, text: str) -> None:
        self._lost = text[:_LONGEST_TEXT]


def read_watch_settings(own: Parameters, mux: str) -> AttendanceSettings:
    """Read the settings from the parameters of the node and of the mux. Raises UserError."""
    return AttendanceSettings(
        grace=own.of(mux).number("lease_timeout", LEASE_TIMEOUT, minimum=0.5, maximum=60.0),
        limit=own.number("hold_limit", 600.0, minimum=0.0),
    )
