import enum

from rclpy.duration import Duration

class DurabilityPolicy(enum.IntEnum):
    VOLATILE = ...
    TRANSIENT_LOCAL = ...

class ReliabilityPolicy(enum.IntEnum):
    RELIABLE = ...
    BEST_EFFORT = ...

class HistoryPolicy(enum.IntEnum):
    KEEP_LAST = ...
    KEEP_ALL = ...

class LivelinessPolicy(enum.IntEnum):
    AUTOMATIC = ...
    MANUAL_BY_TOPIC = ...

class QoSProfile:
    durability: DurabilityPolicy
    reliability: ReliabilityPolicy
    history: HistoryPolicy
    liveliness: LivelinessPolicy
    depth: int
    lifespan: Duration
    deadline: Duration
    liveliness_lease_duration: Duration
    def __init__(
        self,
        *,
        depth: int = ...,
        history: HistoryPolicy = ...,
        reliability: ReliabilityPolicy = ...,
        durability: DurabilityPolicy = ...,
        lifespan: Duration = ...,
    ) -> None: ...

qos_profile_action_status_default: QoSProfile
