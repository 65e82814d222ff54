"""Rate limits for events: token buckets, without a clock."""

from dataclasses import dataclass, field, replace


@dataclass(frozen=True, slots=True)
class Bucket:
    """A token bucket: `rate` events per second on average, and `burst` at once.

    `level` is the number of remaining tokens at the time `at`.
    """

    rate: float
    burst: float
    level: float
    at: float


def make_bucket(rate: float, burst: float, now: float) -> Bucket:
    """Return a full bucket."""
    return Bucket(rate, burst, burst, now)


def draw(bucket: Bucket, now: float) -> tuple[Bucket, bool]:
    """Take a token; return the new bucket, and whether the event is allowed."""
    level = min(bucket.burst, bucket.level + bucket.rate * max(0.0, now - bucket.at))
    allowed = level >= 1.0
    return replace(bucket, level=level - 1.0 if allowed else level, at=now), allowed


@dataclass(slots=True)
class Buckets:
    """A bucket for each client, such as an address or a session; only the `most` latest clients are kept."""

    rate: float
    burst: float
    most: int = 1000
    _buckets: dict[str, Bucket] = field(default_factory=dict)

    def allows(self, client: str, now: float) -> bool:
        """Take a token from a client's bucket; return whether the event is allowed."""
        bucket = self._buckets.pop(client, None) or make_bucket(self.rate, self.burst, now)
        self._buckets[client], allowed = draw(bucket, now)
        while len(self._buckets) > self.most:
            del self._buckets[next(iter(self._buckets))]
        return allowed


@dataclass(slots=True)
class SharedBuckets:
    """A bucket for each client, and one `of_all` that what a client's own bucket allows is drawn from, too."""

    of_each: Buckets
    of_all: Bucket

    def allows(self, client: str, now: float) -> bool:
        """Take a token from both buckets; return whether the event is allowed."""
        if not self.of_each.allows(client, now):
            return False
        self.of_all, allowed = draw(self.of_all, now)
        return allowed
