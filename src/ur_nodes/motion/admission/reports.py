"""Reports of commands that were refused: lines in the log, not one a command, `/diagnostics`, and `ur doctor`."""

import math
from contextlib import suppress
from functools import partial

from ur.devices.driver_health import RefusedCommands, health_file, write_health
from ur_nodes.motion.admission.admission import Refusal
from ur_nodes.motion.admission.probation import rate_needed
from ur_nodes.motion.lease.text import Lease
from ur_nodes.motion.mux_events import Source
from ur_nodes.motion.writes import AsideLog
from ur_nodes.ports.node import Node, Publisher
from ur_nodes.ports.raw import Fields

_EVERY = 5.0  # s
_PERIOD = 1.0  # s
_SHOWN = 10.0  # s after the last command that was refused


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
        self._log.warn(f"{text}; help: {help}" if help else text)
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
