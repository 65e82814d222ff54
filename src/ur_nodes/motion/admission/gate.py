"""Commands, locks and lease requests from topics: the mux gets what `admission` admits, the rest is reported."""

import math
import os
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial

from ur.devices.driver_health import RefusedCommands, health_file, write_health
from ur_nodes.motion.admission.admission import Admission, Refusal, admit_plain, admit_request, admit_stamped, challenge
from ur_nodes.motion.admission.probation import LockRelease, describe_slow, rate_needed, step_lock_release
from ur_nodes.motion.challenge.freshness import IssuedChallenges
from ur_nodes.motion.lease.record import LeaseRecord, start_lease
from ur_nodes.motion.lease.text import FREE, Lease, make_store, read_lease, read_request, write_lease
from ur_nodes.motion.mux_events import Event, LockMessage, MuxSettings, Source, Velocity, VelocityCommand, slow_to
from ur_nodes.motion.velocity_kind import NAMES, KindWatch
from ur_nodes.motion.writes import AsideLog, Writes, attempt
from ur_nodes.ports.node import SECOND, Node, Publisher, Sender, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Fields
from ur_nodes.ports.values import StampedTwist, Time, Twist

_EVERY = 5.0  # s
_PERIOD = 1.0  # s
_AGAIN = 60.0  # s until the log has the same again
_SHOWN = 10.0  # s after the last command that was refused
_SILENCE = 1.0  # s without a stamped command, after which challenges come less often
_QUIET_PERIOD = 0.05  # s between them: the newest one is then still young enough for a command that begins
_LATE = 0.25  # s after which the next one does not wait for an output
_NEARLY = 0.75  # of a period


class RefusalReports:
    """Reports a refusal in the log once, and while it lasts in `/diagnostics` and in a file for `ur doctor`."""

    def __init__(self, node: Node) -> None:
        self._node, self._log = node, AsideLog(node)
        self._refused, self._at = RefusedCommands("", ""), -math.inf
        self._file = health_file(node.name)
        self._diagnostics: Publisher[Fields | bytes] | None = None
        with suppress(LookupError):
            self._diagnostics = node.raw.publish("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        node.every(_PERIOD, self._beat, steady=True)
        node.on_end(lambda: self._file.unlink(missing_ok=True))

    def report(self, text: str, help: str) -> None:
        """Report what is refused, and how to be accepted."""
        self._log.warn(f"{text}; help: {help}" if help else text, every=_AGAIN)
        self._refused, self._at = RefusedCommands(text[:300], help[:300]), self._node.steady()

    def go_on(self) -> None:
        """Note another command of those that are refused."""
        self._at = self._node.steady() if self._lasts() else self._at

    def _lasts(self) -> bool:
        return self._node.steady() - self._at < _SHOWN

    def _beat(self) -> None:
        lasts, refused = self._lasts(), self._refused
        if self._diagnostics is not None:
            text = f"{refused.text}; {refused.help}" if lasts else "no commands are refused"
            status = {"level": int(lasts), "name": f"{self._node.name}: commands", "message": text}
            self._diagnostics.send({"status": [status]})
        if lasts:
            self._node.work(partial(write_health, self._file, refused), lambda _: None, "refused")


class DropReports:
    """Counts dropped commands, and reports the counts periodically."""

    def __init__(self, freshness: float) -> None:
        """`freshness` (s) is how old a command may be."""
        self._freshness = freshness
        self._counts: dict[tuple[Source, Refusal, bool], tuple[int, str]] = {}
        self._logged_at: dict[tuple[Source, Refusal, bool], float] = {}

    def count(self, source: Source, refusal: Refusal, name: str, *, stamped: bool) -> None:
        """Count a command of a publisher. Those on probation are not counted: it may be about to drive."""
        if refusal != "on probation":
            key = (source, refusal, stamped)
            self._counts[key] = self._counts.get(key, (0, ""))[0] + 1, name

    def lines(self, now: float, lease: Lease) -> list[tuple[str, str]]:
        """Return the lines that are due, one for each source and reason, each with a help."""
        due = [key for key in self._counts if now - self._logged_at.get(key, -math.inf) >= _EVERY]
        lines = []
        for key in due:
            source, refusal, stamped = key
            self._logged_at[key] = now
            number, name = self._counts.pop(key)
            topic = f"{source.topic}_stamped" if stamped else source.topic
            what = "1 command" if number == 1 else f"{number} commands"
            what += f" of {name}" if name else ""
            text = f"{source.name}: dropped {what} on {topic}: {self._explain(refusal, lease)}"
            help_ = f"publish Twist on {source.topic} at {rate_needed(source.timeout)} Hz or more"
            lines.append((text, help_ if refusal == "late" else ""))
        return lines

    def _explain(self, refusal: Refusal, lease: Lease) -> str:
        if refusal == "late":
            return f"older than {self._freshness:g} s or without an answer to a challenge of this mux"
        if refusal == "held back":
            return (
                f"sent more than {self._freshness:g} s earlier than the fastest one of the same program; "
                "where the clock of its computer was set back, start the program again"
            )
        if refusal == "not the driver":
            program = f" ({lease.program})" if lease.program else ""
            return f"{lease.name or 'another client'}{program} drives"
        if refusal == "driver silent":
            return f"{lease.name or 'the client'} ({lease.program}), on whose terms the robot drives, is silent"
        if refusal == "displaced":
            return "a program that answers challenges drives by the same source"
        return "frame_id is not the id of a client"


_FACT = "lease"  # mirrors the lease
_MOST_PUBLISHERS = 256  # that are remembered
_SILENT = 1.0  # s without a command, after which programs that send another kind are heard
_MEMORY = 60.0  # s: in which the driver of before a restart of the master may return


class AdmissionGate:
    """Owns an Admission: issues challenges, publishes the lease, and passes on the commands that are admitted.

    `handle` is called with every event for the mux. Commands count from their challenge's issue; under simulated time,
    where nothing real moves, from their arrival. A lease takes effect at once, and is published after it is saved, so
    that a published lease survives a crash; one that is lost before that, since it holds the goal, and after a crash
    each is. Commands do not wait for the disk, and the disk not for the master.
    """

    def __init__(
        self,
        node: Node,
        settings: MuxSettings,
        handle: Callable[[Event], object],
        writes: Writes,
        environment: Mapping[str, str],
        *,
        rate: float,
        freshness: float,
        lease_timeout: float,
    ) -> None:
        """`rate` (Hz) is that of the challenges; `freshness` and `lease_timeout` in seconds."""
        self._node, self._settings, self._handle, self._writes = node, settings, handle, writes
        self._log = AsideLog(node)
        self._store = make_store(environment, node.name, str(node.facts.get("run_id", "")))
        self._admission = Admission(
            IssuedChallenges(int.from_bytes(os.urandom(8), "big") % (2**30 * SECOND) + 1),
            self._start_lease(lease_timeout),
            tuple(source.timeout for source in settings.sources),
            freshness,
        )
        self._drops, self._refusals = DropReports(freshness), RefusalReports(node)
        self._foreign: dict[int, ForeignCommands] = {}
        self._named: dict[str, str] = {}  # publishers of plain commands
        self._locks: dict[tuple[int, str], LockRelease] = {}
        self._published: Lease | None = None
        self._saved: Lease | None = None
        self._saving = False
        self._challenge = node.publish("~challenge", Time, Quality.FRESH)
        self._lease = node.publish("~lease", str, Quality.LATCHED)
        node.on_end(self._end)
        node.after(0.0, self._issue, steady=True)
        self._commanded_at = self._issued_at = node.steady()
        self._period = self._timer_period = 1.0 / rate
        self._timer = node.every(self._period, self._issue_due, steady=True)
        for index, source in enumerate(settings.sources):
            if source.foreign:
                self._foreign[index] = ForeignCommands(node, source.topic, partial(self._on_plain, index))
                continue
            # Every plain command counts: a cluster has to be seen as one.
            node.subscribe_from(source.topic, Twist, partial(self._on_plain, index), Quality.EVERY)
            # Likewise every stamped one: those of a client that may not drive must not replace those of the driver.
            stamped = f"{source.topic}_stamped"
            node.subscribe_from(stamped, StampedTwist, partial(self._on_stamped, index), Quality.EVERY)
        for index, lock in enumerate(settings.locks):
            node.subscribe_from(lock.topic, bool, partial(self._take_lock, index), Quality.EVERY)
        node.subscribe_from("~lease_request", str, self._on_request, Quality.EVERY)

    def _start_lease(self, timeout: float) -> LeaseRecord:
        """Restore the lease of a mux that was killed; that of an earlier master for a moment only."""
        stored, same_run = self._store.load()
        if same_run:
            return start_lease(stored or read_lease(self._node.facts.get(_FACT)), timeout, unix=time.time())
        return start_lease(stored, timeout, unix=time.time(), forget_at=self._node.steady() + _MEMORY)

    def _on_stamped(self, index: int, command: StampedTwist, sender: Sender | None) -> None:
        twist, follows = command.twist, self._settings.sources[index].avoids_obstacles
        velocity = Velocity(twist.forward, twist.turn, twist.left)
        now, motion = self._node.steady(), not velocity.still
        stamp = divmod(command.stamp, SECOND)
        known, waited = self._admission, self._waited(sender, now)
        self._admission, verdict = admit_stamped(
            known, index, stamp, command.frame, now, time.time(), motion=motion, follows=follows, waited=waited
        )
        self._pass(index, velocity, now, verdict, _name(sender), stamped=True)
        self._announce()
        silent, self._commanded_at = now - self._commanded_at > _SILENCE, now
        if silent:  # what follows answers a young challenge
            if self._timer_period != _LATE:
                self._set_timer(self._period)
            self._issue()

    def note_output(self, *, more: bool) -> None:
        """Note an output: while `more` follow soon, challenges and messages, which change nothing before, wait."""
        if _NEARLY * self._settings.period <= self._period and not self._node.facts.simulated_time:
            if (period := _LATE if more else self._period) != self._timer_period:
                self._node.hold_messages(more)
                self._set_timer(period)
            self._issue_due()

    def _waited(self, sender: Sender | None, now: float) -> float:
        """The time (s) for which a message has waited for an output; the clock that tells of its arrival may be set."""
        arrived = now if sender is None or sender.arrived is None else sender.arrived
        return min(max(0.0, now - arrived), self._settings.period)

    def _set_timer(self, period: float) -> None:
        self._timer_period = period
        self._timer.cancel()
        self._timer = self._node.every(period, self._issue_due, steady=True)

    def _issue_due(self) -> None:
        now = self._node.steady()
        silent = now - self._commanded_at > _SILENCE
        if now - self._issued_at >= _NEARLY * (max(self._period, _QUIET_PERIOD) if silent else self._period):
            self._issue()

    def _on_plain(self, index: int, twist: Twist, sender: Sender | None) -> None:
        velocity = Velocity(twist.forward, twist.turn, twist.left)
        now, motion = self._node.steady(), not velocity.still
        sent = None
        if sender is not None and sender.sent is not None and sender.arrived is not None:
            sent = (sender.sent, sender.arrived)
        stream = sender.stream if sender else ""
        publisher = _publisher(sender)
        self._named[publisher] = _name(sender)
        while len(self._named) > _MOST_PUBLISHERS:
            del self._named[next(iter(self._named))]
        self._admission, verdict = admit_plain(
            self._admission, index, publisher, now, motion=motion, sent=sent, stream=stream
        )
        self._pass(index, velocity, now, verdict, _name(sender), stamped=False)

    def _pass(
        self, index: int, velocity: Velocity, now: float, verdict: float | Refusal, name: str, *, stamped: bool
    ) -> None:
        """Pass a command of a publisher that is admitted at `now` to the mux; count a refused one."""
        if isinstance(verdict, float):
            terms = self._admission.lease.lease.terms
            if terms is not None:
                share = terms.speed / self._settings.forward.speed
                velocity = slow_to(velocity, share, self._settings, terms.speed)
            self._handle(VelocityCommand(index, velocity, None if self._node.facts.simulated_time else now - verdict))
        elif not velocity.still:
            self._drops.count(self._settings.sources[index], verdict, name, stamped=stamped)
            self._refusals.go_on()

    def _take_lock(self, index: int, locked: bool, sender: Sender | None) -> None:
        """Accept `true` always, and `false` only if it cannot have been delayed for long: see `step_lock_release`."""
        key, lock = (index, _publisher(sender)), self._settings.locks[index]
        known = self._locks.get(key)
        state = known or LockRelease(lock.timeout)
        now = self._node.steady()
        state, obeyed = step_lock_release(state, now - self._waited(sender, now), locked=locked, new=known is None)
        others = [pair for pair in self._locks.items() if pair[0] != key]
        self._locks = dict([*others[-_MOST_PUBLISHERS:], (key, state)])
        if obeyed:
            self._handle(LockMessage(index, locked))
            return
        late = f"{lock.name}: ignored a 'false' of {_name(sender)} on {lock.topic} that may be late; "
        self._log.warn(late + "expected it from a new publisher or five times in a row", every=5.0)

    def _on_request(self, text: str, sender: Sender | None) -> None:
        request = read_request(text)
        if isinstance(request, str):
            self._log.warn(f"{_name(sender)}: ignored a request about the lease: {request}", every=5.0)
            return
        self._admission, counted = admit_request(self._admission, request, self._node.steady(), time.time())
        self._announce()
        if not counted and request.action != "renew":
            self._log.warn(f"ignored the request '{request.action}' of {request.name}: it arrived late", every=5.0)

    def _issue(self) -> None:
        """Issue a challenge, and report what was dropped."""
        self._issued_at = now = self._node.steady()
        if now - self._commanded_at > _SILENCE and self._timer_period < _QUIET_PERIOD:
            self._set_timer(_QUIET_PERIOD)
        self._admission, stamp, slow = challenge(self._admission, now, time.time())
        self._challenge.send(Time(stamp[0] * SECOND + stamp[1]))
        self._announce()
        for line, help_ in self._drops.lines(now, self._admission.lease.lease):
            self._refusals.report(line, help_)
        for index, publisher in slow:
            tool = "rostopic pub" if self._node.raw.encoding == "ros1" else "ros2 topic pub"
            source = self._settings.sources[index]
            kind: type = self._foreign[index].kind if source.foreign else Twist
            does = describe_slow(self._admission.plain[index, publisher], NAMES[kind])
            self._refusals.report(
                f"{source.topic}: {self._named.get(publisher.partition(' ')[0], '')} {does}",
                f"publish at {rate_needed(source.timeout)} Hz or more: "
                f"`{tool} -r 20 {self._node.resolve(source.topic)} ...`",
            )

    def _announce(self) -> None:
        """Save the lease if it has changed, then publish it. One save at a time; later changes are saved afterwards."""
        lease = self._admission.lease.lease
        if lease.state == "lost" and lease != self._published:
            self._publish(lease)
        if self._saving or lease is self._saved or lease == self._saved:
            return
        self._saving = True

        def save() -> str:
            try:
                self._store.save(lease)
            except OSError as problem:
                return f"{self._store.path}: the lease is not saved: {problem.strerror}"
            return ""

        def publish(problem: str) -> None:
            if problem:
                self._log.warn(problem, every=60.0)
            if self._admission.lease.lease.state != "lost":
                self._publish(lease)
            self._saving, self._saved = False, lease
            self._writes.write(_FACT, partial(self._node.facts.set, _FACT, write_lease(lease)))
            self._announce()

        self._node.work(save, publish, "disk")

    def _publish(self, lease: Lease) -> None:
        self._published = lease
        self._lease.send(write_lease(lease))

    def _end(self) -> None:
        """Free the lease; only a mux that died keeps it."""
        self._node.work(lambda: attempt(self._store.clear), lambda _done: None, "disk")
        self._writes.write(_FACT, partial(self._node.facts.set, _FACT, write_lease(FREE)))


def _name(sender: Sender | None) -> str:
    return sender.name if sender else ""


def _publisher(sender: Sender | None) -> str:
    """The id of a publisher, or its name where it has none; a name may become known late."""
    return sender.id or sender.name if sender else ""


class ForeignCommands:
    """Commands that third-party programs send to the base itself, on a topic that the mux has taken over.

    Subscribes to Twist or TwistStamped, depending on the publishers; the stamp in a header is not trusted.
    """

    def __init__(self, node: Node, topic: str, callback: Callable[[Twist, Sender | None], None]) -> None:
        self._node, self._topic, self._take = node, topic, callback
        self._received_at = -math.inf
        self.kind: type = Twist
        self._subscription = self._subscribe()  # at once: a program's first commands do not wait for the graph
        text = "commands are read as NAME, which programs send"
        KindWatch(node, topic, node.kinds_sent, self._use, text, lambda: node.steady() - self._received_at > _SILENT)

    def _use(self, kind: type) -> None:
        if kind is not self.kind:
            self.kind = kind
            self._subscription.close()
            self._subscription = self._subscribe()

    def _subscribe(self) -> Subscription:
        # Every command counts: a cluster has to be seen as one.
        return self._node.subscribe_from(self._topic, self.kind, self._receive, Quality.EVERY)

    def _receive(self, value: Twist | StampedTwist, sender: Sender | None) -> None:
        self._received_at = self._node.steady()
        self._take(value.twist if isinstance(value, StampedTwist) else value, sender)
