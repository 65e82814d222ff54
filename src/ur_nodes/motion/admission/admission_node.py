"""Commands, locks and lease requests over ROS: what `admission` lets through reaches the mux."""

from __future__ import annotations

import contextlib
import math
import os
import secrets
import threading
import time
from collections.abc import Callable

import rospy
from geometry_msgs.msg import Twist, TwistStamped
from std_msgs.msg import Bool, String, Time

from ur_nodes.motion.admission.admission import (
    Admission,
    Refusal,
    admit_plain,
    admit_request,
    admit_stamped,
    challenge,
)
from ur_nodes.motion.admission.probation import LockRelease, rate_needed, step_lock_release
from ur_nodes.motion.admission.reports import Reports
from ur_nodes.motion.challenge.freshness import Challenges
from ur_nodes.motion.clock import read_steady_time
from ur_nodes.motion.lease.record import LeaseRecord, start_lease
from ur_nodes.motion.lease.store import make_store
from ur_nodes.motion.lease.text import FREE, Lease, read_lease, read_request, write_lease
from ur_nodes.motion.mux_events import Command, Event, LockMessage, MuxSettings, Velocity
from ur_nodes.rosio.ending import quiet_at_end

LEASE_PARAMETER = "/ur/lease"
_QUEUE = 100  # plain commands: a cluster has to be seen as one
_MOST_PUBLISHERS = 256  # of locks, that are remembered
_SECOND = 1_000_000_000
_MEMORY = 60.0  # s: for the driver before the master was started anew to return
_LAST_SAVE = 2.0  # s


class AdmissionRunner:
    """Owns an Admission: issues challenges, publishes the lease, and passes on the commands that are admitted.

    `handle` is called with every event for the mux. Commands count from their challenge's issue if the mux's clock is
    steady; under simulated time, where nothing real moves, from their arrival.
    """

    def __init__(
        self,
        settings: MuxSettings,
        handle: Callable[[Event], object],
        *,
        rate: float,
        freshness: float,
        lease_timeout: float,
        steady: bool,
    ) -> None:
        """`rate` (Hz) is that of the challenges; `freshness` and `lease_timeout` in seconds."""
        self._settings = settings
        self._handle = handle
        self._steady = steady
        self._lock = threading.Lock()
        self._store = make_store(os.environ, rospy.get_name(), str(rospy.get_param("/run_id", "")))
        self._admission = Admission(
            Challenges(secrets.randbelow(2**30 * _SECOND) + 1),
            self._start_lease(lease_timeout),
            tuple(source.timeout for source in settings.sources),
            freshness,
        )
        self._reports = Reports(freshness)
        self._locks: dict[tuple[int, str], LockRelease] = {}
        self._period = 1.0 / rate
        self._ended = threading.Event()
        self._changed = threading.Condition(self._lock)
        self._decided: Lease | None = None
        self._announced: Lease | None = None
        self._challenge = rospy.Publisher("~challenge", Time, queue_size=1, tcp_nodelay=True)
        self._lease = rospy.Publisher("~lease", String, queue_size=1, latch=True, tcp_nodelay=True)
        loops = (self._run, self._announce, self._mirror)
        self._threads = [threading.Thread(target=each, name=each.__name__, daemon=True) for each in loops]
        rospy.on_shutdown(self._end)
        for thread in self._threads:
            thread.start()
        self._subscribe()

    def _start_lease(self, timeout: float) -> LeaseRecord:
        """The lease of the mux that was killed before; that of an earlier master for a moment only."""
        stored, same_run = self._store.load()
        if same_run:
            before = stored or read_lease(rospy.get_param(LEASE_PARAMETER, None))
            return start_lease(before, timeout, unix=time.time())
        return start_lease(stored, timeout, unix=time.time(), forget_at=read_steady_time() + _MEMORY)

    def _subscribe(self) -> None:
        for index, source in enumerate(self._settings.sources):
            topic, stamped = source.topic, f"{source.topic}_stamped"
            rospy.Subscriber(topic, Twist, self._on_plain, index, queue_size=_QUEUE, tcp_nodelay=True)
            rospy.Subscriber(stamped, TwistStamped, self._on_stamped, index, queue_size=1, tcp_nodelay=True)
        for index, lock in enumerate(self._settings.locks):
            rospy.Subscriber(lock.topic, Bool, self._on_lock, index, queue_size=_QUEUE, tcp_nodelay=True)
        rospy.Subscriber("~lease_request", String, self._on_request, queue_size=20, tcp_nodelay=True)

    @quiet_at_end
    def _on_stamped(self, message: TwistStamped, index: int) -> None:
        velocity = self._velocity_of(message.twist, index)
        stamp, client = message.header.stamp, message.header.frame_id
        with self._lock:
            now = read_steady_time()
            self._admission, verdict = admit_stamped(
                self._admission,
                index,
                (stamp.secs, stamp.nsecs),
                client,
                now,
                time.time(),
                motion=not velocity.still,
            )
            self._pass(index, velocity, now, verdict, stamped=True)
            self._note_lease()

    @quiet_at_end
    def _on_plain(self, message: Twist, index: int) -> None:
        velocity = self._velocity_of(message, index)
        with self._lock:
            now = read_steady_time()
            self._admission, verdict = admit_plain(
                self._admission, index, _caller(message), now, motion=not velocity.still
            )
            self._pass(index, velocity, now, verdict, stamped=False)

    def _pass(self, index: int, velocity: Velocity, now: float, verdict: float | Refusal, *, stamped: bool) -> None:
        """Let the mux have a command that is admitted at `now`, and count one that is not."""
        if isinstance(verdict, float):
            self._handle(Command(index, velocity, now - verdict if self._steady else None))
        elif not velocity.still:
            self._reports.count(self._settings.sources[index], verdict, stamped=stamped)

    def _velocity_of(self, twist: Twist, index: int) -> Velocity:
        velocity = Velocity(twist.linear.x, twist.angular.z)
        if not (math.isfinite(velocity.forward) and math.isfinite(velocity.turn)):
            source = self._settings.sources[index]
            rospy.logwarn_throttle(
                5.0, f"{source.name}: a command on {source.topic} is not finite, expected numbers; taken as stop"
            )
            return Velocity()
        return velocity

    @quiet_at_end
    def _on_lock(self, message: Bool, index: int) -> None:
        """Obey `true` always, and `false` when it cannot have been held back for long: see `step_lock_release`."""
        key = (index, _caller(message))
        with self._lock:
            known = self._locks.get(key)
            state, obeyed = step_lock_release(
                known or LockRelease(self._settings.locks[index].timeout),
                read_steady_time(),
                locked=bool(message.data),
                new=known is None,
            )
            others = [pair for pair in self._locks.items() if pair[0] != key]
            self._locks = dict([*others[-_MOST_PUBLISHERS:], (key, state)])
            if obeyed:
                self._handle(LockMessage(index, bool(message.data)))
                return
        lock = self._settings.locks[index]
        rospy.logwarn_throttle(
            5.0,
            f"{lock.name}: ignored a 'false' of {key[1]} on {lock.topic} that may be late; "
            "expected it from a new publisher or five times in a row",
        )

    @quiet_at_end
    def _on_request(self, message: String) -> None:
        request = read_request(message.data)
        if isinstance(request, str):
            rospy.logwarn_throttle(5.0, f"{_caller(message)}: ignored a request about the lease {request}")
            return
        with self._lock:
            self._admission, counted = admit_request(self._admission, request, read_steady_time(), time.time())
            self._note_lease()
        if not counted and request.action != "renew":
            rospy.logwarn_throttle(5.0, f"ignored the request '{request.action}' of {request.name}: it arrived late")

    def _note_lease(self) -> None:
        """Have the lease announced if it has changed. It is in force already."""
        if self._admission.lease.lease != self._decided:
            self._decided = self._admission.lease.lease
            self._changed.notify_all()

    @quiet_at_end
    def _announce(self) -> None:
        """Publish each change once it is on the disk: what a client has seen outlives this process.

        Commands do not wait for the disk.
        """
        while not self._ended.is_set():
            with self._changed:
                self._changed.wait_for(lambda: self._decided != self._announced or self._ended.is_set())
                lease = self._decided
            if lease is None or self._ended.is_set():
                return
            try:
                self._store.save(lease)
            except OSError as problem:
                rospy.logwarn_throttle(60.0, f"{self._store.path}: the lease is not saved: {problem.strerror}")
            self._lease.publish(write_lease(lease))
            with self._changed:
                self._announced = lease
                self._changed.notify_all()

    @quiet_at_end
    def _run(self) -> None:
        """Issue challenges until the end."""
        due = read_steady_time()
        while not self._ended.wait(max(0.0, due - read_steady_time())):
            with self._lock:
                now = read_steady_time()
                due = max(due + self._period, now)
                self._admission, stamp, slow = challenge(self._admission, now, time.time())
                self._challenge.publish(Time(rospy.Time(*stamp)))
                self._note_lease()
                lines = self._reports.lines(now, self._admission.lease.lease)
            for line in lines:
                rospy.logwarn(line)
            for index, publisher in slow:
                source = self._settings.sources[index]
                rospy.logwarn(
                    f"{source.topic}: {publisher} does not drive: plain commands need a steady rate of "
                    f"{rate_needed(source.timeout)} Hz or more, five in a row"
                )

    def _mirror(self) -> None:
        """Keep the parameter that mirrors the lease up to date, apart from what must not wait for the master."""
        written: Lease | None = None
        while not self._ended.is_set():
            with self._changed:
                while self._announced == written and not self._ended.is_set():
                    self._changed.wait()
                lease = self._announced
            if lease is not None and not self._ended.is_set():
                with contextlib.suppress(Exception):  # the master may be gone; the topic has the lease
                    rospy.set_param(LEASE_PARAMETER, write_lease(lease))
                written = lease

    def _end(self) -> None:
        """Free the lease: only that of a mux that died is kept."""
        self._ended.set()
        with self._changed:
            self._changed.notify_all()
        self._threads[1].join(_LAST_SAVE)
        with contextlib.suppress(OSError):
            self._store.clear()
        with contextlib.suppress(Exception):
            rospy.set_param(LEASE_PARAMETER, write_lease(FREE))


def _caller(message: object) -> str:
    """The name of the node that has published a message."""
    header = getattr(message, "_connection_header", None) or {}
    return str(header.get("callerid", ""))[:256]
