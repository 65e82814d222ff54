"""The qualities of `ports` as the QoS of ROS 2, compatible with the nodes of Nav2 and RViz 2.

| quality | publisher | subscriber |
|---|---|---|
| NEWEST | reliable, last 1 | best effort, last 1 |
| FRESH | best effort, last 1, lifespan 0.3 s | best effort, last 1 |
| LATCHED | reliable, transient local, last 1 | reliable, transient local, last 1 |
| LATCHED_EVERY | | reliable, transient local, last 100 |
| EVERY | reliable, last 100 | best effort for velocities and what sensors send, else reliable; last 100 |
| COMMAND | reliable, last 1, lifespan 0.3 s | best effort, last 100 |
| LOSSLESS | reliable, all | reliable, all |

Velocities have the lifespan of 0.3 s in each quality but LATCHED. Maps and costmaps are always sent and received as
LATCHED: Nav2 sends a whole costmap once. A reliable publisher reaches all; a best effort subscriber receives all.
`docs/reference/ros2.md` has this table, and a test compares the two.
"""

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from ur_nodes.ports import values
from ur_nodes.ports.qualities import Quality

COMMAND_LIFESPAN = 0.3  # s: an older command is of no use
_QUEUE = 100

_SENT_BY_SENSORS: frozenset[type] = frozenset(
    {values.Scan, values.Range, values.Imu, values.Odometry, values.DriverOdometry, values.Battery, values.Joints}
    | {values.Picture, values.PackedPicture, values.Calibration, values.Joystick}
)
_VELOCITIES: frozenset[type] = frozenset({values.Twist, values.StampedTwist})
_LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_EACH_LATCHED = QoSProfile(
    depth=_QUEUE, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)


def offered(quality: Quality, kind: type = object) -> QoSProfile:
    """Return the profile of a publisher of values of a kind."""
    if quality is Quality.LATCHED or kind is values.Map:
        return _LATCHED
    if quality is Quality.LOSSLESS:
        return _ALL
    fresh = quality is Quality.FRESH
    profile = QoSProfile(
        depth=_QUEUE if quality is Quality.EVERY else 1,
        reliability=ReliabilityPolicy.BEST_EFFORT if fresh else ReliabilityPolicy.RELIABLE,
    )
    if fresh or quality is Quality.COMMAND or kind in _VELOCITIES:
        profile.lifespan = Duration(seconds=COMMAND_LIFESPAN)
    return profile


def requested(quality: Quality, kind: type) -> QoSProfile:
    """Return the profile of a subscriber to values of a kind."""
    if quality is Quality.LATCHED or kind is values.Map:
        return _LATCHED
    if quality is Quality.LATCHED_EVERY:
        return _EACH_LATCHED
    if quality is Quality.LOSSLESS:
        return _ALL
    loose = quality in (Quality.NEWEST, Quality.FRESH, Quality.COMMAND) or kind in _SENT_BY_SENSORS | _VELOCITIES
    reliability = ReliabilityPolicy.BEST_EFFORT if loose else ReliabilityPolicy.RELIABLE
    newest = quality in (Quality.NEWEST, Quality.FRESH)
    return QoSProfile(depth=1 if newest else _QUEUE, reliability=reliability)
