"""Limits on how often something may be done: token buckets, without a clock."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Bucket:
    """Allows `rate` events a second on average, and `burst` at once. `level`: those that are left at the time `at`."""

    rate: float
    burst: float
    level: float
    at: float


def make_bucket(rate: float, burst: float, now: float) -> Bucket:
    """A full bucket."""
    return Bucket(rate, burst, burst, now)


def draw(bucket: Bucket, now: float) -> tuple[Bucket, bool]:
    """Take one event out; whether it is allowed."""
    level = min(bucket.burst, bucket.level + bucket.rate * max(0.0, now - bucket.at))
    allowed = level >= 1.0
    return replace(bucket, level=level - 1.0 if allowed else level, at=now), allowed
