"""Times of the messages of a topic that is recorded."""

from dataclasses import dataclass


@dataclass(slots=True)
class Arrivals:
    """`last` is the time of the newest message that was recorded, in ns."""

    last: int = -(10**18)

    def note(self, moment: int, period: int) -> int | None:
        """Return the time of a message that arrived at a moment; None: less than a period (ns) after the last one.

        Messages are read in the order in which they were sent. One that was lost and sent again arrives after those
        that follow it: they have its time, so that the order stays.
        """
        if period and moment - self.last < period:
            return None
        self.last = max(moment, self.last)
        return self.last
