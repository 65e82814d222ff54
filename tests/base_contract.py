"""What a base gives to the rest, simulated or real: topics with types, and frames."""

from __future__ import annotations

from pathlib import Path

from ur.robot.base import Base, list_bases, list_variants, load_base

PACKAGE = Path(__file__).parents[1] / "ubiquity_launches"
EVERY = [(name, variant) for name in list_bases(PACKAGE) for variant in ("", *list_variants(PACKAGE, name))]


def load(name: str, variant: str) -> Base:
    return load_base(PACKAGE, name, variant)


def list_topics(base: Base) -> dict[str, str]:
    """Topics that a base publishes, absolute, with their types."""
    topics = {"/odom": "nav_msgs/Odometry", "/joint_states": "sensor_msgs/JointState"}
    if base.lidar:
        topics[f"/{base.lidar.topic}"] = "sensor_msgs/LaserScan"
    if base.sonars:
        topics[f"/{base.sonars.topic}"] = "sensor_msgs/Range"
    if base.imu:
        topics[f"/{base.imu.topic}"] = "sensor_msgs/Imu"
    if base.battery:
        topics[f"/{base.battery.topic}"] = "sensor_msgs/BatteryState"
    if base.bumpers:
        topics |= {f"/{base.bumpers.topic}/{bumper.name}": "std_msgs/Bool" for bumper in base.bumpers.at}
    if base.cliffs:
        topics |= {f"/{base.cliffs.topic}/{cliff.name}": "std_msgs/Bool" for cliff in base.cliffs.at}
    if base.raspicam:
        topics[f"/{base.raspicam.name}/image_raw"] = "sensor_msgs/Image"
        topics[f"/{base.raspicam.name}/image/compressed"] = "sensor_msgs/CompressedImage"
        topics[f"/{base.raspicam.name}/camera_info"] = "sensor_msgs/CameraInfo"
    return topics


def list_frames(base: Base) -> set[str]:
    """Frames that messages of a base are in."""
    frames = {"odom", "base_footprint"}
    frames |= {part.frame for part in (base.lidar, base.imu, base.raspicam) if part}
    frames |= {cliff.frame for cliff in (base.cliffs.at if base.cliffs else ())}
    return frames | {sonar.frame for sonar in (base.sonars.at if base.sonars else ())}
