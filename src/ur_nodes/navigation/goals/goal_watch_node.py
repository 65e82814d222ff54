"""The lease and the challenges of the mux, as `move_base` uses them: which goals to accept, drive, hold and cancel."""

from __future__ import annotations

import json
import threading

import rospy
from actionlib_msgs.msg import GoalID
from std_msgs.msg import String

from ur_nodes.motion.challenge.challenge_node import ChallengeLink
from ur_nodes.motion.clock import read_steady_time
from ur_nodes.motion.lease.text import Lease, read_lease
from ur_nodes.navigation.goals.attendance import (
    Act,
    Attendance,
    Settings,
    Verdict,
    attend_goal,
    continue_goal,
    refuse_goal,
    step_attendance,
)
from ur_nodes.navigation.goals.goal_claim import REMEMBERED, Challenges, age_of_answer, note_challenge, read_claim
from ur_nodes.rosio.parameters import Parameters

_LATEST_CONTINUE = 1.0  # s: an older answer to "continue or cancel?" is ignored
_NANO = 1_000_000_000


class GoalWatch:
    """Decides about one goal at a time, from the messages of the mux; may be called from any thread.

    Publishes `~hold` (std_msgs/String, latched, JSON): `goal`, the id of the goal that is held, `state`: `held`,
    `asking` or empty when none is, and `text`. Takes `~continue` (actionlib_msgs/GoalID): the goal that goes on; with
    a `stamp`, the newest challenge, it is ignored when it arrives late.
    """

    def __init__(self, mux: str, settings: Settings) -> None:
        """`mux` is the name of the mux's node."""
        self._settings = settings
        self._lock = threading.Lock()
        self._lease: Lease | None = None
        self._challenges = Challenges()
        self._goal = ""
        self._attendance = Attendance()
        self._reported = True
        self._shown: tuple[str, Act] | None = None
        self._hold = rospy.Publisher("~hold", String, queue_size=1, latch=True)
        self._publish_hold("", Verdict(Act.DRIVE))
        self.link = ChallengeLink(mux, self._on_challenge)
        rospy.Subscriber(f"{mux}/lease", String, self._on_lease, queue_size=1, tcp_nodelay=True)
        rospy.Subscriber("~continue", GoalID, self._on_continue, queue_size=1)

    def accept(self, goal_id: str) -> str:
        """Make this the goal that is decided about; or return why it is refused, and change nothing."""
        claim = read_claim(goal_id)
        with self._lock:
            refusal = refuse_goal(claim, self._lease, self._challenges, read_steady_time())
            if not refusal:
                self._goal, self._attendance, self._reported = goal_id, attend_goal(claim), False
        return refusal

    def finish(self) -> None:
        """Forget the goal: it has ended."""
        with self._lock:
            self._goal = ""
        self._publish_hold("", Verdict(Act.DRIVE))

    def judge(self) -> Verdict:
        """Decide what to do with the goal now, and publish it."""
        now = read_steady_time()
        with self._lock:
            goal, silence = self._goal, self._challenges.silence(now)
            self._attendance, verdict = step_attendance(self._attendance, self._lease, silence, self._settings, now)
            report = not self._reported and self._lease is not None and self._attendance.unattended
            self._reported = self._reported or report
        if report:
            rospy.loginfo("the goal is unattended: nobody holds the lease of the mux, so nothing holds the goal")
        self._publish_hold(goal, verdict)
        return verdict

    def _publish_hold(self, goal: str, verdict: Verdict) -> None:
        """Publish when the state changes; the text grows by seconds and is in the goal's status."""
        held = verdict.act in (Act.HOLD, Act.ASK)
        shown = (goal, verdict.act) if held else ("", Act.DRIVE)
        if shown == self._shown:
            return
        self._shown = shown
        state = verdict.act.value if held else ""
        text = verdict.text if held else ""
        self._hold.publish(json.dumps({"goal": shown[0], "state": state, "text": text}))

    def _on_challenge(self) -> None:
        stamp = self.link.answer(REMEMBERED)
        if stamp is not None:
            with self._lock:
                value = stamp.secs * _NANO + stamp.nsecs
                self._challenges = note_challenge(self._challenges, value, read_steady_time())

    def _on_lease(self, message: String) -> None:
        lease = read_lease(message.data)
        if lease is None:
            rospy.logwarn_throttle(10.0, "the lease of the mux cannot be read, expected its JSON; ignored")
            return
        with self._lock:
            self._lease = lease

    def _on_continue(self, message: GoalID) -> None:
        stamp = message.stamp
        with self._lock:
            age = age_of_answer(self._challenges, stamp.secs * _NANO + stamp.nsecs, read_steady_time())
            late = not stamp.is_zero() and (age is None or age > _LATEST_CONTINUE)
            if message.id in ("", self._goal) and not late:
                self._attendance = continue_goal(self._attendance)
        if late:
            rospy.logwarn("the request to continue the goal arrived late and is ignored")


def read_watch_settings(mux: str) -> Settings:
    """From the parameters of the node and of the mux. Raises UserError."""
    own = Parameters()
    return Settings(
        ask=own.text("on_return", "resume", choices=("resume", "ask")) == "ask",
        grace=Parameters(f"{mux}/").number("lease_timeout", 3.0, minimum=0.5, maximum=60.0),
        limit=own.number("hold_limit", 600.0, minimum=0.0),
    )
