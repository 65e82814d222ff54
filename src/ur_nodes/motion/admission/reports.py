"""Reports of commands that were dropped: one line for each source and reason, not one for each command."""

from __future__ import annotations

import math

from ur_nodes.motion.admission.admission import Refusal
from ur_nodes.motion.lease.text import Lease
from ur_nodes.motion.mux_events import Source

_EVERY = 5.0  # s


class DropReports:
    """Counts dropped commands, and reports the counts periodically."""

    def __init__(self, freshness: float) -> None:
        """`freshness` (s) is how old a command may be."""
        self._freshness = freshness
        self._counts: dict[tuple[Source, Refusal, bool], int] = {}
        self._logged_at: dict[tuple[Source, Refusal, bool], float] = {}

    def count(self, source: Source, refusal: Refusal, *, stamped: bool) -> None:
        """Count a command. Commands on probation are not counted: the publisher may be about to drive."""
        if refusal != "on probation":
            key = (source, refusal, stamped)
            self._counts[key] = self._counts.get(key, 0) + 1

    def lines(self, now: float, lease: Lease) -> list[str]:
        """Return the lines that are due, one for each source and reason."""
        due = [key for key in self._counts if now - self._logged_at.get(key, -math.inf) >= _EVERY]
        lines = []
        for key in due:
            source, refusal, stamped = key
            self._logged_at[key] = now
            number = self._counts.pop(key)
            topic = f"{source.topic}_stamped" if stamped else source.topic
            what = "1 command" if number == 1 else f"{number} commands"
            lines.append(f"{source.name}: dropped {what} on {topic}: {self._explain(refusal, lease)}")
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
