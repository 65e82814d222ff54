"""A clock that a test advances."""


class ManualClock:
    """Seconds that pass when a test sets `now`; by default those of a simulation, that are no round numbers."""

    def __init__(self, now: float = 0.1 + 0.2) -> None:
        self.now = now

    def __call__(self) -> float:
        return self.now
