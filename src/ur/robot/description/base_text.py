"""The text of a base.yaml from a robot description; each value with its source in a comment."""

import json
import math
from collections.abc import Iterator, Sequence

from ur.robot.base.outline import Point
from ur.robot.base.properties import MotionLimits
from ur.robot.description.reading import BRAKING, DescriptionReading
from ur.robot.description.sensing import FoundSensor
from ur.source.printable import one_line

_WHOLE_TURN = 2.0 * math.pi + 0.001  # rad; 6.2832 counts as a full turn


def write_base_file(reading: DescriptionReading, summary: str, origin: str) -> str:
    """Return the text of a base.yaml. `origin` names the description, for a comment. `reading.open` must be empty."""
    assert not reading.open
    return "\n".join(_lines(reading, " ".join(summary.split()), origin)) + "\n"


def _lines(reading: DescriptionReading, summary: str, origin: str) -> Iterator[str]:
    figures = reading.figures
    value = {key: figure.value for key, figure in figures.items()}
    yield f"summary: {json.dumps(summary, ensure_ascii=False)}"
    yield f"# Read from {one_line(origin)} by `ur new base --from`. Figures that are called usual are not from there."
    yield from (f"# {one_line(note)}" for note in reading.notes)
    yield f"footprint: {_points(reading.outline)} # {one_line(figures['length'].source)}"
    if reading.body:
        yield f"body: {_points(reading.body)} # without the wheels"
    for key in ("height", "ground_clearance", "mass"):
        yield f"{key}: {_n(value[key])} # {one_line(figures[key].source)}"
    wheels = ", ".join(f"{key}: {_n(value[f'wheel_{key}'])}" for key in ("radius", "width", "separation", "mass"))
    yield f"wheels: {{{wheels}}}"
    for key in ("wheel_radius", "wheel_width", "wheel_separation", "wheel_mass"):
        yield f"# {key}: {one_line(figures[key].source)}"
    yield "casters:"
    for support in reading.supports:
        place = f"{{x: {_n(support.x)}, y: {_n(support.y)}, radius: {_n(support.radius)}}}"
        yield f"  - {place} # {one_line(support.source)}"
    yield from _limits(reading)
    yield "odometry: # usual"
    yield "  {rate: 20, ticks_per_turn: 1000, wheel_noise: 0.003, radius_error: 0.003, separation_error: 0.006}"
    if reading.sensors:
        yield "sensors:"
    sonars = [sensor for sensor in reading.sensors if sensor.kind == "sonar"]
    for sensor in reading.sensors:
        if sensor.kind == "lidar":
            yield from _lidar(sensor)
        elif sensor.kind == "camera":
            yield from _camera(sensor)
        elif sensor.kind == "imu":
            yield from _imu(sensor)
    if sonars:
        yield from _sonars(sonars)


def limits_of(reading: DescriptionReading) -> MotionLimits:
    """Return the limits of a base from a description: a slow one brakes so hard that it rests within 0.3 s."""
    value = {key: figure.value for key, figure in reading.figures.items()}
    velocity, turning, aside = value["velocity"], value["angular_velocity"], value["lateral_velocity"]
    return MotionLimits(
        velocity=velocity,
        angular_velocity=turning,
        acceleration=value["acceleration"],
        angular_acceleration=2.5,
        deceleration=value.get("deceleration", max(2.0 * value["acceleration"], _up(max(velocity, aside) / BRAKING))),
        angular_deceleration=max(5.0, _up(turning / BRAKING)),
        command_age=0.08,
        lag=0.11,
        lateral_velocity=aside,
    )


def _limits(reading: DescriptionReading) -> Iterator[str]:
    figures, limits = reading.figures, limits_of(reading)
    braking = f"{figures['deceleration'].source}; it " if "deceleration" in figures else "it "
    yield "limits:"
    yield f"  velocity: {_n(limits.velocity)} # {one_line(figures['velocity'].source)}"
    yield f"  angular_velocity: {_n(limits.angular_velocity)} # {one_line(figures['angular_velocity'].source)}"
    if limits.sideways:
        yield f"  lateral_velocity: {_n(limits.lateral_velocity)} # {one_line(figures['lateral_velocity'].source)}"
    yield f"  acceleration: {_n(limits.acceleration)} # {one_line(figures['acceleration'].source)}"
    yield f"  angular_acceleration: {_n(limits.angular_acceleration)} # usual"
    yield f"  deceleration: {_n(limits.deceleration)} # {one_line(braking + limits.describe_stop())}"
    yield f"  angular_deceleration: {_n(limits.angular_deceleration)}"
    yield f"  command_age: {_n(limits.command_age)}"


def _lidar(sensor: FoundSensor) -> Iterator[str]:
    samples = int(sensor.figure("samples", 360, 2, 4096))
    start = sensor.figure("angle_min", -math.pi, -_WHOLE_TURN, _WHOLE_TURN)
    end = sensor.figure("angle_max", math.pi * (1.0 - 2.0 / samples), -_WHOLE_TURN, _WHOLE_TURN)
    if not start < end <= start + _WHOLE_TURN:
        start, end = -math.pi, math.pi * (1.0 - 2.0 / samples)
    near = sensor.figure("range_min", 0.12, 0.0, 5.0)
    far = sensor.figure("range_max", 12.0, max(0.5, near + 0.1), 100.0)
    yield f"  lidar: # {one_line(sensor.source)}{'' if sensor.gazebo else '; figures: usual'}"
    yield f"    {{frame: {sensor.frame}, topic: scan, pose: {_pose(sensor)},"
    yield f"     angle_min: {_n(start, 8)}, angle_max: {_n(end, 8)}, samples: {samples},"
    yield f"     rate: {_n(sensor.figure('rate', 8.0, 1.0, 50.0))}, range_min: {_n(near)}, range_max: {_n(far)},"
    yield f"     noise: {_n(sensor.figure('noise', 0.01, 0.0, 0.2))}}}"


def _camera(sensor: FoundSensor) -> Iterator[str]:
    width, height = (int(sensor.figure(key, usual, 16, 4096)) for key, usual in (("width", 640), ("height", 480)))
    view, rate = sensor.figure("field_of_view", 1.0856, 0.1, 2.6), sensor.figure("rate", 15.0, 1.0, 30.0)
    yield f"  raspicam: # {one_line(sensor.source)}{'' if sensor.gazebo else '; figures: usual'}"
    yield f"    {{frame: {sensor.frame}, pose: {_pose(sensor)},"
    yield f"     width: {width}, height: {height}, field_of_view: {_n(view)}, rate: {_n(rate)}}}"


def _imu(sensor: FoundSensor) -> Iterator[str]:
    yield f"  imu: # {one_line(sensor.source)}; noise: usual"
    yield f"    {{frame: {sensor.frame}, topic: imu/data, pose: {_pose(sensor)},"
    yield f"     rate: {_n(sensor.figure('rate', 50.0, 1.0, 200.0))}, gyro_noise: 0.001, accel_noise: 0.03}}"


def _sonars(sensors: Sequence[FoundSensor]) -> Iterator[str]:
    first = sensors[0]
    view = first.figure("angle_max", 0.218, 0.01, 1.5) - first.figure("angle_min", -0.218, -1.5, -0.01)
    yield f"  sonars: # {one_line(first.source)}; figures not of Gazebo: usual"
    yield f"    topic: sonars\n    rate: {_n(first.figure('rate', 4.0, 1.0, 20.0))}\n    field_of_view: {_n(view)}"
    yield f"    range_min: {_n(first.figure('range_min', 0.02, 0.0, 0.4))}"
    yield f"    range_max: {_n(first.figure('range_max', 4.0, 0.5, 20.0))}\n    noise: 0.005"
    yield "    at:"
    yield from (f"      {sensor.frame}: {_pose(sensor)}" for sensor in sensors)


def _pose(sensor: FoundSensor) -> str:
    return f"[{', '.join(_n(number, 4) for number in (*sensor.pose.at, *sensor.pose.angles()))}]"


def _points(points: Sequence[Point]) -> str:
    return f"[{', '.join(f'[{_n(x)}, {_n(y)}]' for x, y in points)}]"


def _up(value: float) -> float:
    return math.ceil(round(value * 100.0, 6)) / 100.0


def _n(value: float, digits: int = 4) -> str:
    """Format a number for YAML, never with an exponent."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text
