from collections.abc import Callable
from typing import Protocol

class MatchedInfo(Protocol):
    current_count: int
    current_count_change: int

class PublisherEventCallbacks:
    def __init__(
        self, *, matched: Callable[[MatchedInfo], None] | None = ..., use_default_callbacks: bool = ...
    ) -> None: ...

class SubscriptionEventCallbacks:
    def __init__(self, *, use_default_callbacks: bool = ...) -> None: ...
