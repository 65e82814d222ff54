"""Values of every kind, and their comparison."""

import numpy as np
from tests.ur_nodes.ports.stage import STAMP

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.ports import fiducials, values
from ur_nodes.ports.actions import GoalId
from ur_nodes.ports.values import Transform, Twist

POSES = np.array([(1.0, 2.0, 0.5), (-1.0, 0.0, -3.0)])
GRID = Grid(np.array([[0, 100, -1], [7, 0, 0]], np.int8), 0.05, Pose2(-1.0, 2.0, 0.0))
MARKER = values.Marker(
    *("three", 7, "line_list", Pose2(1.0, 0.5, 0.0).in_space(), (0.125, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), "lines"),
    np.array([(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)]),
    np.array([(1.0, 0.0, 0.0, 0.5), (0.0, 1.0, 0.0, 0.5)]),
)
CLOUD = np.array(
    [(1.0, 2.0, 3.0, 0x102030), (4.0, 5.0, 6.0, 0)], [("x", "<f4"), ("y", "<f4"), ("z", "<f8"), ("rgb", "<u4")]
)
CALIBRATION = values.Calibration(STAMP, "camera", 4, 2, "plumb_bob", (0.5,) * 5, (2.0,) * 9, (1.0,) * 9, (4.0,) * 12)

VALUES: tuple[object, ...] = (
    "some text",
    True,
    0.25,
    -7,
    values.Number(0.1),
    values.Signal(),
    values.LogLine("/camera", "error", "no lens"),
    values.Time(STAMP),
    values.ClockTime(STAMP),
    Twist(0.5, -0.25, 0.125, 0.0625, -0.5, 1.5),
    values.StampedTwist(STAMP, "client", Twist(0.5, 0.0)),
    values.Odometry(STAMP, "odom", "base", Pose2(1.0, 2.0, 0.5), Twist(0.5, 0.25), np.eye(3) * 0.5, np.eye(3) * 0.25),
    values.DriverOdometry(STAMP, 1.0, 2.0, (0.0, 0.0, 0.6, 0.8), 0.5, 0.25),
    values.Scan(STAMP, "laser", -1.5, 0.25, 0.125, 8.0, np.array([1.0, np.inf, np.nan], np.float32)),
    values.Range(STAMP, "sonar", 1.5, 0.25, 0.125, 4.0),
    values.Imu(STAMP, "imu", (0.0, 0.0, 0.0, 1.0), (0.5, 0.0, 0.0), (0.0, 0.0, 9.75), 0.5, 0.25, 0.125),
    values.Battery(STAMP, 12.5, -1.5, 2.5, 4.0, 0.625, technology="nimh"),
    values.Joints(STAMP, ("left", "right"), (0.5, -0.5), (1.0, 2.0)),
    values.Joystick(STAMP, (0.5, -1.0), (0, 1)),
    values.StampedPose(STAMP, "map", Pose2(1.0, 2.0, 0.5)),
    values.PoseEstimate(STAMP, "map", Pose2(1.0, 2.0, 0.5), np.arange(9.0).reshape(3, 3)),
    values.Poses(STAMP, "map", POSES),
    values.Path(STAMP, "map", POSES),
    GoalId("a goal", STAMP),
    values.Outline(STAMP, "map", np.array([(0.5, 0.25), (1.0, 2.0)])),
    values.Map(STAMP, "map", GRID),
    values.MapInfo(STAMP, 0.0625, 3, 2, Pose2(1.0, 2.0, 0.5)),
    values.MapUpdate(STAMP, "map", 1, 2, np.array([[1, 2], [3, 4]], np.int8)),
    values.Markers(
        STAMP,
        "map",
        (
            values.Marker("one", 1, "cube", Pose2(1.0, 2.0, 0.0).in_space(), (0.5, 0.5, 0.25), (1.0, 0.5, 0.25, 1.0)),
            values.Marker(
                "one", 2, "text", Pose2(1.0, 2.0, 0.0).in_space(), (0.0, 0.0, 0.5), (1.0, 1.0, 1.0, 1.0), "7"
            ),
            values.Marker(
                *("two", 1, "points", Pose2(0.0, 0.0, 0.0).in_space(), (0.125, 0.125, 0.0), (0.0, 0.0, 1.0, 1.0), ""),
                np.array([(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)]),
            ),
        ),
    ),
    values.MarkerChange(STAMP, "map", "delete", MARKER, 1.5),
    values.MarkerChanges(
        (values.MarkerChange(STAMP, "map", "put", MARKER), values.MarkerChange(0, "", "clear", MARKER))
    ),
    values.PointCloud(STAMP, "lidar", CLOUD),
    values.Picture(STAMP, "camera", 2, 1, "rgb8", 6, b"\x01\x02\x03\x04\x05\x06"),
    CALIBRATION,
    values.PackedPicture(STAMP, "camera", "jpeg", b"\xff\xd8"),
    fiducials.SeenFiducials(STAMP, "camera", 7, (fiducials.FiducialCorners(3, np.arange(8.0).reshape(4, 2)),) * 2),
    fiducials.StampedFiducials(
        STAMP, "camera", 7, (fiducials.FiducialPose(3, Pose3(1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0), 0.5, 0.25, 100.0),)
    ),
    fiducials.MappedFiducials((fiducials.MappedFiducial(3, (1.0, 2.0, 0.5), (0.0, 0.5, -0.25)),)),
    (Transform(STAMP, "odom", "base", Pose3(1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0)),) * 2,
)


def fields_of(value: object) -> object:
    """A value in a form that compares: arrays as lists, NaN as a word."""
    if isinstance(value, np.ndarray):
        return [("nan" if each != each else each) for each in value.ravel().tolist()], value.shape
    if isinstance(value, float) and value != value:
        return "nan"
    if isinstance(value, tuple) and any(hasattr(type(each), "__dataclass_fields__") for each in value):
        return tuple(map(fields_of, value))
    names = getattr(type(value), "__dataclass_fields__", None)
    if names is None or isinstance(value, Grid):
        return (fields_of(value.values), value.resolution, value.origin) if isinstance(value, Grid) else value
    left_out = {"angle_max"} if getattr(value, "angle_max", 0) is None else set()
    both = {"angle_max", "sequence"} | left_out  # figures of a driver and of the middleware
    return {name: fields_of(getattr(value, name)) for name in names if name not in both}
