"""fiducial_detect and fiducial_slam on a bus: pictures of fiducials that are drawn where a robot sees them."""

import functools
import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.ur_nodes.vision.synthetic import CAMERA, HEIGHT, MOUNT, WIDTH, Marker, project
from tests.ur_nodes.vision.test_detect import SIZE, draw

from ur.source.diagnostic import UserError
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.rigid import from_angles, from_planar, invert, to_pose
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.fiducials import FiducialCorners, MappedFiducials, SeenFiducials, StampedFiducials
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Silent, Trigger
from ur_nodes.ports.values import (
    Calibration,
    Markers,
    PackedPicture,
    Picture,
    PoseEstimate,
    Result,
    Transform,
)
from ur_nodes.vision.fiducial_detect_node import FiducialDetect
from ur_nodes.vision.fiducial_map import read_map, write_map
from ur_nodes.vision.fiducial_slam_node import FiducialSlamNode

CALIBRATION = Calibration(
    *(0, "raspicam", WIDTH, HEIGHT, "plumb_bob", (0.0,) * 5, tuple(CAMERA.matrix.ravel().tolist())),
    *(tuple(np.eye(3).ravel().tolist()), tuple(np.eye(3, 4).ravel().tolist())),
)
UNCALIBRATED = Calibration(0, "raspicam", WIDTH, HEIGHT, "", (), (0.0,) * 9, (0.0,) * 9, (0.0,) * 12)
# On walls ahead of the robot, turned a little so that it is clear how.
FIDUCIALS = tuple(
    Marker(number, from_angles((x, y, z), (math.pi / 2, 0.0, -math.pi / 2 + turn)), SIZE)
    for number, x, y, z, turn in (
        (101, 2.6, 0.9, 0.9, 0.5),
        (102, 2.8, 0.3, 0.6, -0.4),
        (103, 2.7, -0.4, 1.0, 0.4),
        (104, 2.9, -0.8, 0.6, -0.7),
    )
)
PATH = [Pose2(0.1 * step, 0.0, 0.0) for step in range(8)]


@functools.cache
def jpeg_at(pose: Pose2) -> bytes:
    """What the camera takes there."""
    camera_from_map = invert(from_planar(pose) @ MOUNT)
    poses = {each.id: camera_from_map @ each.pose for each in FIDUCIALS}
    seen = {number: place for number, place in poses.items() if project(place, SIZE) is not None}
    return cv2.imencode(".jpg", draw(seen))[1].tobytes()


class FiducialRobot:
    """Drives with a camera and exact wheels; keeps the newest value of each topic."""

    def __init__(self, calibration: Calibration = CALIBRATION) -> None:
        self.bus = Bus()
        self.bus.parameters |= {"/detect/fiducial_len": SIZE, "/slam/fiducial_len": SIZE}
        self.world = self.bus.node("world")
        self.newest: dict[str, object] = {}
        self.count = 0
        self.transforms: dict[tuple[str, str], Transform] = {}
        self._pictures = self.world.publish("camera/compressed", PackedPicture)
        self._info, self._calibration = self.world.publish("camera_info", Calibration), calibration
        self.world.transforms.send(Transform(0, "base_footprint", "raspicam", to_pose(MOUNT), fixed=True))
        self.world.subscribe("/tf", tuple, self._on_transforms, Quality.EVERY)

    def listen(self, **topics: type) -> None:
        for topic, kind in topics.items():
            quality = Quality.LATCHED if kind in (Markers, MappedFiducials) else Quality.NEWEST
            self.world.subscribe(topic, kind, functools.partial(self.newest.__setitem__, topic), quality)

    def send(self, data: bytes) -> None:
        self.count += 1
        self._info.send(self._calibration)
        self._pictures.send(PackedPicture(self.bus.now, "raspicam", "jpeg", data, self.count))
        self.bus.run(0.2)

    def drive(self, path: list[Pose2]) -> None:
        for pose in path:
            self.world.transforms.send(Transform(self.bus.now, "odom", "base_footprint", pose.in_space()))
            self.send(jpeg_at(pose))

    def ask(self, service: str, request: object) -> Result:
        got: list[Result] = []
        self.world.call(service, request, got.append)
        self.bus.run(0.1)
        return got[0]

    def correction(self) -> Pose2 | None:
        """The pose of odom in map, as far as it is known now."""
        found = self.transforms.get(("map", "odom"))
        return found.pose.planar() if found and found.stamp > self.bus.now else None

    def _on_transforms(self, transforms: tuple[Transform, ...]) -> None:
        self.transforms |= {(each.parent, each.child): each for each in transforms}


@pytest.fixture
def map_file(tmp_path: Path) -> Path:
    """The map of the fiducials."""
    path = tmp_path / "maps" / "map.txt"
    robot = FiducialRobot()
    build_map(robot, path)
    assert robot.ask("save_map", Trigger()).success
    return path


def build_map(robot: FiducialRobot, path: Path) -> None:
    robot.bus.load_parameters("/slam", {"map_file": str(path)})
    FiducialDetect(robot.bus.node("detect"))
    FiducialSlamNode(robot.bus.node("slam"))
    robot.drive(PATH)


def localise(path: Path) -> FiducialRobot:
    robot = FiducialRobot()
    robot.bus.load_parameters("/slam", {"map_file": str(path), "read_only_map": True})
    FiducialDetect(robot.bus.node("detect"))
    FiducialSlamNode(robot.bus.node("slam"))
    robot.listen(fiducial_pose=PoseEstimate, fiducials=Markers)
    robot.drive(PATH[:2])
    return robot


def test_fiducials_of_a_picture_are_published_with_poses_frames_and_drawings() -> None:
    robot = FiducialRobot()
    FiducialDetect(robot.bus.node("detect"))
    robot.listen(
        fiducial_vertices=SeenFiducials,
        fiducial_transforms=StampedFiducials,
        fiducial_images=Picture,
        **{"fiducial_images/compressed": PackedPicture},
    )
    robot.drive(PATH[:2])
    seen, placed = robot.newest["fiducial_vertices"], robot.newest["fiducial_transforms"]
    assert isinstance(seen, SeenFiducials)
    assert isinstance(placed, StampedFiducials)
    assert (seen.frame, seen.picture, placed.picture) == ("raspicam", 2, 2)
    assert [each.number for each in seen.fiducials] == [each.id for each in FIDUCIALS]
    camera_from_map = invert(from_planar(PATH[1]) @ MOUNT)
    for each, marker in zip(placed.fiducials, FIDUCIALS, strict=True):
        assert each.image_error < 1.0
        assert each.object_error < 0.01
        truth = to_pose(camera_from_map @ marker.pose)
        assert math.dist(each.pose[:3], truth[:3]) < 0.05
        assert robot.transforms["raspicam", f"fiducial_{each.number}"].pose == each.pose
    drawn, packed = robot.newest["fiducial_images"], robot.newest["fiducial_images/compressed"]
    assert isinstance(drawn, Picture)
    assert (drawn.width, drawn.height, len(drawn.data)) == (WIDTH, HEIGHT, 3 * WIDTH * HEIGHT)
    assert isinstance(packed, PackedPicture)
    assert packed.data[:2] == b"\xff\xd8"


def test_picture_that_is_none_is_reported_and_detection_goes_on() -> None:
    robot = FiducialRobot()
    node = robot.bus.node("detect")
    FiducialDetect(node)
    robot.listen(fiducial_vertices=SeenFiducials)
    robot.send(b"nonsense")
    assert robot.newest == {}
    assert ("warn", "a compressed image of 8 bytes ('jpeg'), expected JPEG or PNG") in node.lines
    robot.send(jpeg_at(PATH[0]))
    assert "fiducial_vertices" in robot.newest


def test_camera_without_calibration_gives_corners_only_and_is_named_once() -> None:
    robot = FiducialRobot(UNCALIBRATED)
    node = robot.bus.node("detect")
    FiducialDetect(node)
    robot.listen(fiducial_vertices=SeenFiducials, fiducial_transforms=StampedFiducials)
    robot.drive(PATH[:2])
    assert set(robot.newest) == {"fiducial_vertices"}
    assert node.lines == [("warn", "/camera_info: the camera is not calibrated (K is 0): no poses")]


def test_of_pictures_that_arrive_during_a_detection_only_the_newest_is_processed() -> None:
    robot = FiducialRobot()
    robot.bus.durations["pictures"] = 0.5
    FiducialDetect(robot.bus.node("detect"))
    numbers: list[int] = []
    robot.world.subscribe("fiducial_vertices", SeenFiducials, lambda seen: numbers.append(seen.picture))
    robot.drive(PATH[:5])
    robot.bus.run(1.0)
    assert numbers == [1, 3, 5]


def test_raw_pictures_are_taken_where_a_parameter_asks_for_them() -> None:
    robot = FiducialRobot()
    robot.bus.parameters["/detect/image_transport"] = "raw"
    FiducialDetect(robot.bus.node("detect"))
    robot.listen(fiducial_vertices=SeenFiducials)
    grey = cv2.imdecode(np.frombuffer(jpeg_at(PATH[0]), np.uint8), cv2.IMREAD_GRAYSCALE)
    picture = Picture(robot.bus.now, "raspicam", WIDTH, HEIGHT, "mono8", WIDTH, np.asarray(grey, np.uint8).tobytes())
    robot.world.publish("camera", Picture).send(picture)
    robot.bus.run(0.1)
    seen = robot.newest["fiducial_vertices"]
    assert isinstance(seen, SeenFiducials)
    assert len(seen.fiducials) == len(FIDUCIALS)


def test_fiducials_are_mapped_shown_and_saved(tmp_path: Path) -> None:
    path = tmp_path / "maps" / "map.txt"
    robot = FiducialRobot()
    robot.listen(fiducials=Markers, fiducial_map=MappedFiducials, fiducial_pose=PoseEstimate)
    build_map(robot, path)
    correction = robot.correction()
    assert correction is not None
    assert math.hypot(correction.x, correction.y) < 0.05  # the wheels do not err
    robot.bus.run(1.0)
    shown, markers = robot.newest["fiducial_map"], robot.newest["fiducials"]
    assert isinstance(shown, MappedFiducials)
    assert isinstance(markers, Markers)
    assert [each.number for each in shown.fiducials] == [each.id for each in FIDUCIALS]
    assert len(markers.markers) == 2 * len(FIDUCIALS)
    assert robot.ask("save_map", Trigger()) == Result(True, f"{len(FIDUCIALS)} fiducials written to {path}")
    truth = {each.id: each.pose[:3, 3] for each in FIDUCIALS}
    for entry in read_map(path):
        assert np.linalg.norm(entry.pose[:3, 3] - truth[entry.id]) < 0.1


def test_map_is_saved_by_itself_when_it_has_changed_and_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "map.txt"
    robot = FiducialRobot()
    build_map(robot, path)
    robot.bus.run(10.0)
    first = path.read_text()
    path.unlink()
    robot.bus.run(20.0)
    assert not path.exists()  # nothing has changed since
    robot.drive([Pose2(0.75, 0.0, 0.2)])
    robot.bus.nodes["/slam"].end("done")
    assert path.exists()
    assert path.read_text() != first


def test_map_that_cannot_be_saved_is_reported(tmp_path: Path) -> None:
    robot = FiducialRobot()
    build_map(robot, tmp_path)  # which is a folder
    answer = robot.ask("save_map", Trigger())
    assert not answer.success
    assert "cannot be written" in answer.text


def test_cleared_map_is_built_anew_from_where_the_robot_is(tmp_path: Path) -> None:
    robot = FiducialRobot()
    robot.listen(fiducial_map=MappedFiducials)
    build_map(robot, tmp_path / "map.txt")
    assert robot.ask("clear_map", Silent()).success
    robot.bus.run(1.0)
    assert robot.newest["fiducial_map"] == MappedFiducials(())
    correction = robot.correction()
    assert correction is not None
    assert math.hypot(correction.x, correction.y) < 0.05


def test_map_that_is_shifted_shifts_the_robot_and_stays_as_it_is(map_file: Path) -> None:
    entries = read_map(map_file)
    for entry in entries:
        entry.pose[0, 3] += 1.0
    write_map(map_file, entries)
    before = map_file.read_text()
    robot = localise(map_file)
    pose = robot.newest["fiducial_pose"]
    assert isinstance(pose, PoseEstimate)
    assert pose.pose.x == pytest.approx(1.0 + PATH[1].x, abs=0.1)
    assert pose.covariance[0, 0] > 0.0
    assert not robot.ask("clear_map", Silent()).success
    robot.bus.run(20.0)
    assert map_file.read_text() == before


def test_place_that_is_forgotten_is_not_published_until_it_is_found_again(map_file: Path) -> None:
    robot = localise(map_file)
    assert robot.correction() is not None
    assert robot.ask("global_localization", Silent()).success
    robot.bus.run(1.0)
    assert robot.correction() is None
    robot.drive(PATH[2:3])
    assert robot.correction() is not None


def test_given_place_is_taken_in_the_frame_of_a_map_that_is_only_read(map_file: Path) -> None:
    robot = localise(map_file)
    robot.ask("global_localization", Silent())
    places = robot.world.publish("initialpose", PoseEstimate)
    places.send(PoseEstimate(robot.bus.now, "odom", Pose2(5.0, 0.0, 0.0), np.eye(3)))
    robot.bus.run(0.1)
    wanted = "expected one in frame 'map' while the map is only read (~read_only_map)"
    assert ("warn", f"initialpose in frame 'odom' is of no use now, {wanted}") in robot.bus.nodes["/slam"].lines
    places.send(PoseEstimate(robot.bus.now, "map", Pose2(5.0, 0.0, 0.0), np.eye(3)))
    robot.bus.run(0.1)
    empty = cv2.imencode(".jpg", np.full((HEIGHT, WIDTH), 200, np.uint8))[1].tobytes()
    robot.world.transforms.send(Transform(robot.bus.now, "odom", "base_footprint", Pose2(0.0, 0.0, 0.0).in_space()))
    robot.send(empty)
    correction = robot.correction()
    assert correction is not None
    assert correction.x == pytest.approx(5.0, abs=0.01)


def test_corners_are_used_when_the_frames_of_their_time_are_known(map_file: Path) -> None:
    robot = localise(map_file)
    del robot.newest["fiducial_pose"]
    taken = robot.bus.now
    robot.send(jpeg_at(PATH[2]))
    assert "fiducial_pose" not in robot.newest
    robot.world.transforms.send(Transform(taken, "odom", "base_footprint", PATH[2].in_space()))
    robot.bus.run(0.1)
    assert "fiducial_pose" in robot.newest


def test_localising_without_a_map_is_refused(tmp_path: Path) -> None:
    bus = Bus()
    bus.load_parameters("/slam", {"map_file": str(tmp_path / "none.txt"), "read_only_map": True})
    with pytest.raises(UserError, match=r"none\.txt.*expected a map of fiducials"):
        FiducialSlamNode(bus.node("slam"))


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("dictionary", 99, "dictionary: 99, expected a number from 0 to"),
        ("dictionary", "5X5_100O", "'5X5_100O', expected one of"),
        ("image_transport", "theora", "expected one of compressed, raw"),
    ],
)
def test_detection_refuses_parameters_that_cannot_be(name: str, value: object, message: str) -> None:
    bus = Bus()
    bus.load_parameters("/detect", {name: value})
    with pytest.raises(UserError, match=message):
        FiducialDetect(bus.node("detect"))


@pytest.mark.parametrize("wrong", [math.nan, math.inf, 1e300])
def test_what_no_camera_can_see_is_overlooked_and_the_map_goes_on(tmp_path: Path, wrong: float) -> None:
    robot = FiducialRobot()
    robot.listen(fiducial_pose=PoseEstimate)
    build_map(robot, tmp_path / "map.txt")
    corners = np.array([(300.0, 220.0), (340.0, 220.0), (340.0, 260.0), (300.0, wrong)])
    seen = robot.world.publish("fiducial_vertices", SeenFiducials)
    far = robot.world.transforms
    for number, where in ((7, 1.0), (-1, 1.0), (8, wrong)):
        far.send(Transform(robot.bus.now, "odom", "base_footprint", Pose2(where, 0.0, 0.0).in_space()))
        found = FiducialCorners(number, corners)
        seen.send(
            SeenFiducials(robot.bus.now, "raspicam", 0, (found, FiducialCorners(-1, corners[:1] + np.zeros((4, 2)))))
        )
        robot.bus.run(0.5)
    robot.newest.clear()
    robot.drive([Pose2(0.8, 0.0, 0.0), Pose2(1.0, 0.0, 0.0)])
    assert robot.newest
    assert robot.ask("save_map", Trigger()).success


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_camera_whose_calibration_is_not_finite_counts_as_uncalibrated(wrong: float) -> None:
    robot = FiducialRobot(replace(CALIBRATION, matrix=(wrong, *CALIBRATION.matrix[1:])))
    robot.listen(fiducial_vertices=SeenFiducials, fiducial_transforms=StampedFiducials)
    node = robot.bus.node("detect")
    FiducialDetect(node)
    robot.drive(PATH[:1])
    assert set(robot.newest) == {"fiducial_vertices"}
    assert any("camera_info: message of" in text and "matrix is" in text for _, text in node.lines)
