"""What a base gives to the rest, simulated or real: topics with types, and frames."""

from pathlib import Path

from ur.robot.base import Base, list_bases, list_variants, load_base

PACKAGE = Path(__file__).parents[1] / "ubiquity_launches"
EVERY = [(name, variant) for name in list_bases(PACKAGE) for variant in ("", *list_variants(PACKAGE, name))]


def load(name: str, variant: str) -> Base:
    return load_base(PACKAGE, name, variant)


def list_topics(base: Base) -> dict[str, str]:
    """Topics that a base publishes, absolute, with their types."""
    topics = {"/odom": "nav_msgs/Odometry", "/joint_states": "sensor_msgs/JointState"}
    return topics | {f"/{name}": kind for _, sensor in base.list_sensors() for name, kind in sensor.topics().items()}


def list_frames(base: Base) -> set[str]:
    """Frames that messages of a base are in."""
    frames = {"odom", "base_footprint"}
    return frames.union(*(sensor.frames() for _, sensor in base.list_sensors()))
