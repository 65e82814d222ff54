"""Parameter files of one base, adapted to another base's outline and speeds."""

import math
import re

from ur.robot.base.properties import Base

_OUTLINE = re.compile(r"^( *footprint:)\s*\[\[[^#]*?\]\]", re.MULTILINE)
_BUMPERS = re.compile(r"^  bumper_layer:.*\n(?:    .*\n)+", re.MULTILINE)
_SHARE = 0.6  # of the highest speed, at which a person starts to steer
_EXPECTED = 8.0  # scans per second, the minimum unless a file sets another
_LOOK = 1.0  # m beyond the way that navigation takes to brake
_BRAKING = 0.6  # of the acceleration: the braking of `ur_nodes.navigation`
_LOCAL, _SEEN = 4.0, 2.5  # m: the least side of the local costmap, and the least distance up to which it is marked


def fit_parameters(text: str, like: str, base: Base, navigation: tuple[float, float] | None = None) -> str:
    """Return the parameter file of base `like`, adapted to another base's outline, speeds and scan rate.

    `navigation`: its highest velocity and angular velocity, m/s and rad/s; by default those of the base.
    """
    points = ", ".join(f"[{x:g}, {y:g}]" for x, y in base.footprint)
    text = _OUTLINE.sub(rf"\1 [{points}]", text)
    text = _BUMPERS.sub(lambda found: _list_bumpers(found[0], base), text)
    text = _fit_sideways(text, base)
    values = _list_values(base, navigation) | (_list_distances(base) if "rolling_window:" in text else {})
    for key, value in values.items():
        text = re.sub(rf"^( *{key}:) *[-+.\de]+(?=\s)", rf"\1 {value:g}", text, flags=re.MULTILINE)
    if base.lidar and base.lidar.rate < _EXPECTED and "odom_model_type:" in text:
        text = re.sub(
            r"^transform_tolerance: .*", f"transform_tolerance: {2.0 / base.lidar.rate:g} # s", text, flags=re.M
        )
    return re.sub(r"^#.*", lambda line: re.sub(rf"\b{re.escape(like)}\b", base.name, line[0]), text, flags=re.MULTILINE)


def _fit_sideways(text: str, base: Base) -> str:
    """Adapt what depends on whether a base drives sideways."""
    limits, aside = base.limits, base.limits.lateral_velocity
    text = re.sub(r"\b(?:diff|omni)(?=-corrected\b)", "omni" if aside else "diff", text)
    values = (f"{aside:g}", f"-{aside:g}", f"{limits.acceleration:g}", "5") if aside else ("0.0", "0.0", "0.0", "1")
    for key, value in zip(("max_vel_y", "min_vel_y", "acc_lim_y", "vy_samples"), values, strict=True):
        text = re.sub(rf"^( *{key}:) *[-+.\de]+(?=\s)", rf"\1 {value}", text, flags=re.MULTILINE)
    for key, share in (("scale_linear", _SHARE), ("scale_linear_turbo", 1.0)):
        ahead, left = _round(share * limits.velocity), _round(share * aside)
        scale = f"{{x: {ahead:g}, y: {left:g}}}" if aside else f"{ahead:g}"
        text = re.sub(rf"^{key}: (?:\{{.*?\}}|[.\de]+)", f"{key}: {scale}", text, flags=re.MULTILINE)
    text = re.sub(r"^speed_lim_y: .*\n", "", text, flags=re.MULTILINE)
    if aside:
        text = re.sub(r"^speed_lim_v: .*\n", rf"\g<0>speed_lim_y: {aside:g}\n", text, flags=re.MULTILINE)
    if aside and "odom_alpha5" not in text:
        text = re.sub(r"^(odom_alpha)4(: .*)", r"\g<0>\n\g<1>5\2", text, flags=re.MULTILINE)
    return text


def _list_bumpers(layer: str, base: Base) -> str:
    """Return the layer of a costmap that marks what bumpers press, with those of a base; '' without any."""
    if base.bumpers is None:
        return ""
    topics = ", ".join(f"{base.bumpers.topic}/{each.name}" for each in base.bumpers.at)
    sectors = ", ".join(f"[{each.start:g}, {each.end:g}]" for each in base.bumpers.at)
    return layer.splitlines()[0] + f"\n    topics: [{topics}]\n    sectors: [{sectors}]\n"


def _list_values(base: Base, navigation: tuple[float, float] | None) -> dict[str, float]:
    limits = base.limits
    speed, turn = navigation or (limits.velocity, limits.angular_velocity)
    slow, slow_turn = _round(_SHARE * limits.velocity), _round(_SHARE * limits.angular_velocity)
    values = {
        "max_vel_trans": speed,
        "max_vel_x": speed,
        "max_vel_theta": turn,
        "acc_lim_x": limits.acceleration,
        "acc_lim_theta": limits.angular_acceleration,
        "speed": slow,
        "turn": slow_turn,
        "scale_angular": slow_turn,
        "scale_angular_turbo": limits.angular_velocity,
        "speed_limit": limits.velocity,
        "turn_limit": limits.angular_velocity,
        "speed_lim_v": limits.velocity,
        "speed_lim_w": limits.angular_velocity,
        "accel_lim_v": limits.acceleration,
        "accel_lim_w": limits.angular_acceleration,
        "decel_factor": min(2.0, _round(limits.deceleration / limits.acceleration)),
    }
    if base.lidar and base.lidar.rate < _EXPECTED:  # scans arrive less often than the files expect
        values["expected_update_rate"] = _round(4.5 / base.lidar.rate)
    return values


def _list_distances(base: Base) -> dict[str, float]:
    """Return how far a local costmap has to reach, so that navigation can brake before what is marked in it."""
    speed = max(base.limits.velocity, base.limits.lateral_velocity)
    reach = _LOOK + 0.5 * speed + speed * speed / (2.0 * _BRAKING * base.limits.acceleration)
    seen = max(_SEEN, _round(min(reach, base.lidar.range_max if base.lidar else reach)))
    side = max(_LOCAL, 2.0 * math.ceil(reach))
    return {"width": side, "height": side, "obstacle_range": seen, "raytrace_range": seen + 0.5}


def _round(value: float) -> float:
    """Round down to three decimals."""
    return int(value * 1000.0 + 1e-6) / 1000.0
