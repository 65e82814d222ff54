"""Descriptions of others become bases: every figure that they hold is read, and only the rest is asked for."""

from pathlib import Path

import pytest
from tests.robot.description.urdfs import FOUR_WHEELS, MESHES, SMALL

from ur.robot.base import Base, read_base
from ur.robot.description.base_text import write_base_file
from ur.robot.description.parse import parse_urdf
from ur.robot.description.reading import BRAKING, DescriptionReading, Figure, read_base_figures
from ur.robot.description.speed_files import FoundSpeeds
from ur.source.diagnostic import UserError
from ur.tools.new.description import describe_reading

SPEEDS = {"velocity": 0.5, "angular_velocity": 1.2}


def read(text: str, **given: float) -> DescriptionReading:
    return read_base_figures(parse_urdf(text, "robot.urdf"), given)


def make_base(tmp_path: Path, text: str, **given: float) -> Base:
    path = tmp_path / "base.yaml"
    path.write_text(write_base_file(read(text, **given), "A robot.", "robot.urdf"), encoding="utf-8")
    return read_base(path, "robot")


def test_small_robot_is_read_from_its_shapes_and_gazebo_tags(tmp_path: Path) -> None:
    assert read(SMALL).open == ()
    base = make_base(tmp_path, SMALL, **SPEEDS)
    assert (base.wheels.radius, base.wheels.width, base.wheels.separation) == (0.033, 0.018, 0.16)
    assert base.wheels.mass == pytest.approx(0.03)
    assert base.mass == pytest.approx(0.965)
    assert min(x for x, _ in base.footprint) == pytest.approx(-0.1)
    assert max(y for _, y in base.footprint) == pytest.approx(0.089), "the wheels stand out of the body"
    assert max(y for _, y in base.body) == pytest.approx(0.07)
    assert base.height == pytest.approx(0.15)
    assert [(caster.x, caster.y) for caster in base.casters] == [(-0.081, 0.0)]
    assert base.limits.acceleration == 1.0
    lidar = base.lidar
    assert lidar is not None
    assert (lidar.frame, lidar.samples, lidar.rate, lidar.range_max) == ("base_scan", 360, 5.0, 3.5)
    assert (lidar.angle_min, lidar.angle_max) == (0.0, 6.28319)
    assert lidar.pose == pytest.approx((-0.032, 0, 0.182, 0, 0, 0))
    assert base.imu is not None
    assert (base.imu.frame, base.imu.rate) == ("imu_link", 100.0)


def test_skid_steer_has_its_wheels_between_the_axles_and_supports_below_them(tmp_path: Path) -> None:
    base = make_base(tmp_path, FOUR_WHEELS, **SPEEDS)
    assert base.wheels.separation == pytest.approx(0.5708)
    assert base.wheels.mass == pytest.approx(5.2), "of both wheels of a side"
    assert [(caster.x, caster.y) for caster in base.casters] == [(0.256, 0.0), (-0.256, 0.0)]
    assert base.ground_clearance == pytest.approx(0.13)
    assert max(y for _, y in base.footprint) == pytest.approx(0.343)
    assert base.lidar is not None
    assert base.lidar.pose[:3] == pytest.approx((0.3, 0.0, 0.485)), "above the ground, which lies below the root"
    assert base.raspicam is not None
    assert base.raspicam.frame == "camera_optical_frame"
    assert base.raspicam.pose == pytest.approx((0.45, 0.0, 0.435, 0.0, 0.1, 0.0)), "the body looks along x"


def test_meshes_take_their_size_from_the_inertia_and_speeds_come_from_joints(tmp_path: Path) -> None:
    found = read(MESHES)
    assert found.open == ()
    assert any("base_link is a mesh" in note for note in found.notes)
    base = make_base(tmp_path, MESHES)
    assert max(x for x, _ in base.footprint) == pytest.approx(0.15, abs=0.02)
    assert base.limits.velocity == pytest.approx(0.4)
    assert base.limits.angular_velocity == 1.5, "faster turns cannot be stopped in time"
    assert [(round(caster.x, 3), caster.radius) for caster in base.casters] == [(-0.27, 0.05)]
    assert base.sonars is not None
    assert [sonar.frame for sonar in base.sonars.at] == ["sonar_0", "sonar_1"]
    assert base.sonars.at[1].pose == pytest.approx((0.1, -0.1, 0.15, 0.0, 0.0, -0.5))


def test_size_that_an_inertia_cannot_mean_is_asked_for() -> None:
    copied = MESHES.replace('ixx="0.2"', 'ixx="20"').replace('iyy="0.29"', 'iyy="29"').replace('izz="0.41"', 'izz="41"')
    found = read(copied)
    assert found.open == ("length", "width", "height")
    assert any("base_link is a mesh without a size" in note for note in found.notes)


def test_robot_that_steers_like_a_car_is_told_apart() -> None:
    knuckle = (
        '<joint name="left_steering" type="revolute"><parent link="base_link"/><child link="knuckle"/>'
        '<origin xyz="0.3 0.1 0"/><axis xyz="0 0 1"/><limit lower="-0.5" upper="0.5"/></joint><link name="knuckle"/>'
        '<joint name="steered_wheel" type="continuous"><parent link="knuckle"/><child link="steered"/>'
        '<axis xyz="0 1 0"/></joint><link name="steered"/></robot>'
    )
    notes = read(FOUR_WHEELS.replace("</robot>", knuckle)).notes
    assert any("steers by left_steering, as a car does" in note for note in notes)
    assert not any("as a car" in note for text in (SMALL, FOUR_WHEELS, MESHES) for note in read(text).notes)


@pytest.mark.parametrize("text", [SMALL, FOUR_WHEELS, MESHES], ids=["small", "four", "meshes"])
def test_base_stops_in_time_whatever_its_description_says(tmp_path: Path, text: str) -> None:
    limits = make_base(tmp_path, text, velocity=0.6, angular_velocity=1.5).limits
    assert limits.velocity / limits.deceleration <= BRAKING
    assert limits.angular_velocity / limits.angular_deceleration <= BRAKING


def test_description_without_shapes_is_asked_for_everything_at_once(tmp_path: Path) -> None:
    bare = '<robot name="bare"><link name="base_link"/></robot>'
    names = ("length", "width", "height", "mass", "wheel_radius", "wheel_separation")
    assert read(bare).open == names
    answers = dict(zip(names, (0.4, 0.3, 0.2, 5.0, 0.05, 0.3), strict=True))
    base = make_base(tmp_path, bare, **answers)
    assert base.wheels.radius == 0.05
    assert len(base.casters) == 2, "one in front and one behind, so that it does not tip over"


def test_given_size_replaces_the_one_that_is_read(tmp_path: Path) -> None:
    base = make_base(tmp_path, SMALL, **SPEEDS, length=0.3, mass=2.0)
    assert max(x for x, _ in base.footprint) - min(x for x, _ in base.footprint) == pytest.approx(0.3, abs=0.002)
    assert base.mass == 2.0


@pytest.mark.parametrize(
    ("text", "old", "new"),
    [
        (SMALL, 'length="0.018"', 'length="-1"'),
        (SMALL, "<min>0.12</min>", "<min>4</min>"),
        (MESHES, 'radius="0.05"', 'radius="-2"'),
        (SMALL, "<samples>360</samples>", "<samples>many</samples>"),
    ],
)
def test_figure_that_no_base_can_have_is_replaced(tmp_path: Path, text: str, old: str, new: str) -> None:
    assert old in text
    assert make_base(tmp_path, text.replace(old, new), **SPEEDS).casters


def test_joint_limit_that_nobody_set_is_not_taken_for_a_speed() -> None:
    assert read(MESHES.replace('velocity="4.0"', 'velocity="1000"')).figures["velocity"] == Figure(0.5, "usual")


def test_speed_that_nothing_says_is_the_usual_one_with_a_note() -> None:
    found = read(SMALL)
    assert [found.figures[key].value for key in ("velocity", "angular_velocity")] == [0.5, 1.5]
    assert [note for note in found.notes if "change `limits` in base.yaml" in note]
    assert not [note for note in read(SMALL, **SPEEDS).notes if "usual" in note]


def test_fast_base_brakes_as_the_files_around_it_say_or_as_is_usual(tmp_path: Path) -> None:
    speeds = FoundSpeeds("controller of control.yaml", 2.0, 4.0, 20.0, 3.0)
    found = read_base_figures(parse_urdf(SMALL, "robot.urdf"), {}, speeds=speeds)
    text = write_base_file(found, "A robot.", "robot.urdf")
    assert "rests within 1.1 m, from 2 m/s" in text
    assert "deceleration: 3 # controller of control.yaml; it brakes within 0.2 s of its last command" in text
    (tmp_path / "base.yaml").write_text(text, encoding="utf-8")
    limits = read_base(tmp_path / "base.yaml", "robot").limits
    assert (limits.velocity, limits.angular_velocity, limits.acceleration, limits.deceleration) == (2.0, 1.5, 1.0, 3.0)
    assert limits.fast
    assert limits.way_to_rest == pytest.approx(0.4 + 4.0 / 6.0)
    assert make_base(tmp_path, SMALL, velocity=3.0).limits.deceleration == 2.0
    assert not make_base(tmp_path, SMALL, velocity=0.6).limits.fast


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot>", "cannot be read as a URDF: no element found"),
        ("<sdf/>", "begins with <sdf>, expected a URDF"),
        ('<!DOCTYPE r [<!ENTITY a "b">]><robot/>', "a document type, expected XML without one"),
        ("<robot/>", "no link, expected"),
        ("<robot><material name='a'/><kobuki/></robot>", "no link, and <kobuki> is not an element of URDF"),
        ('<robot><link name="a"/><link name="b"/></robot>', "2 links without a parent"),
        ('<robot><link name="a"/><link name="a"/></robot>', "link 'a' is given twice"),
        (
            '<robot><link name="a"/><joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>',
            "joint 'j' names link 'b', which does not exist",
        ),
        (
            '<robot><link name="a"/><link name="b"/><link name="c"/>'
            '<joint name="j" type="fixed"><parent link="b"/><child link="c"/></joint>'
            '<joint name="k" type="fixed"><parent link="c"/><child link="b"/></joint></robot>',
            "joints form a loop",
        ),
        (SMALL.replace("0.14 0.14 0.14", "0.14 nan 0.14"), "link 'base_link': size of <box> is '0.14 nan 0.14'"),
        (SMALL.replace('value="0.8"', 'value="-1"'), "link 'base_link': mass -1, expected at least 0"),
        (MESHES.replace('type="continuous"', 'type="round"', 1), "type 'round', expected one of fixed"),
    ],
)
def test_bad_description_is_refused_with_its_link_or_joint(text: str, message: str) -> None:
    with pytest.raises(UserError) as caught:
        read(text)
    assert message in str(caught.value)
    assert str(caught.value).startswith("robot.urdf: ")


def test_cliff_sensor_is_no_lidar() -> None:
    floor = SMALL.replace('name="lds"', 'name="cliff_sensor_left"').replace("<max>3.5</max>", "<max>0.15</max>")
    sources = {sensor.kind: sensor.source for sensor in read(floor).sensors}
    assert sources["lidar"] == "link base_scan, by its name"
    other = floor.replace("base_scan", "cliff_left_link")
    assert not read(other).has_lidar


def test_ranger_of_a_few_rays_is_no_lidar() -> None:
    few = SMALL.replace("<samples>360</samples>", "<samples>2</samples>").replace("base_scan", "front_sensor")
    found = read(few)
    assert not found.has_lidar
    assert [sensor.frame for sensor in found.sensors if sensor.kind == "sonar"] == ["front_sensor"]


def test_lidar_that_the_file_lacks_is_put_on_top_and_one_that_it_has_is_left_out_when_asked(tmp_path: Path) -> None:
    bare = SMALL.replace("base_scan", "cliff_left_link").replace("<max>3.5</max>", "<max>0.15</max>")
    added = read_base_figures(parse_urdf(bare, "robot.urdf"), SPEEDS, lidar=True)
    path = tmp_path / "base.yaml"
    path.write_text(write_base_file(added, "A robot.", "robot.urdf"), encoding="utf-8")
    base = read_base(path, "robot")
    assert base.lidar is not None
    assert (base.lidar.frame, base.lidar.pose[2] > base.height) == ("laser", True)
    assert not read_base_figures(parse_urdf(SMALL, "robot.urdf"), SPEEDS, lidar=False).has_lidar


def test_blank_and_byte_order_mark_before_the_declaration_are_no_fault() -> None:
    assert parse_urdf("\ufeff \n" + SMALL, "robot.urdf").name == "small"


def test_depth_that_is_not_simulated_and_casters_that_are_used_are_told() -> None:
    camera = '<gazebo reference="base_link"><sensor type="depth" name="eye"/></gazebo></robot>'
    text = MESHES.replace("</robot>", camera)
    found = read_base_figures(parse_urdf(text, "robot.urdf"), {}, lidar=True)
    assert "camera base_link_frame is a depth camera: its picture is simulated, its depth is not" in found.notes
    assert "read: caster at x -0.27, y 0 (link " in describe_reading(read(MESHES))


def test_depth_camera_stands_for_the_lidar_that_the_file_lacks(tmp_path: Path) -> None:
    camera = (
        '<gazebo reference="base_link"><sensor type="rgbd" name="eye"><camera><horizontal_fov>1.2</horizontal_fov>'
        "</camera><update_rate>15</update_rate></sensor></gazebo></robot>"
    )
    bare = SMALL.replace("base_scan", "cliff_left_link").replace("<max>3.5</max>", "<max>0.15</max>")
    text = bare.replace("</robot>", camera)
    base = make_base(tmp_path, text, **SPEEDS)
    assert base.lidar is not None
    assert base.raspicam is not None
    assert (base.lidar.angle_min, base.lidar.angle_max) == pytest.approx((-0.6, 0.6))
    assert (base.lidar.frame, base.lidar.rate, base.lidar.range_max) == ("base_link_depth", 15.0, 8.0)
    assert any("n_depthimage_to_laserscan" in note for note in read(text, **SPEEDS).notes)
    assert not read_base_figures(parse_urdf(text, "robot.urdf"), SPEEDS, lidar=False).has_lidar
