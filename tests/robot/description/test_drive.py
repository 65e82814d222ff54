"""Driven wheels, supports and steering are told apart, however a description models them."""

from tests.robot.description.urdfs import FOUR_WHEELS, MESHES, SMALL

from ur.robot.description.base_text import write_base_file
from ur.robot.description.drive import DriveGeometry, find_drive
from ur.robot.description.parse import parse_urdf
from ur.robot.description.reading import DescriptionReading, read_base_figures

ARM = (
    '<joint name="pan" type="revolute"><parent link="base_link"/><child link="shoulder"/>'
    '<origin xyz="0.1 0 0.6"/><axis xyz="0 0 1"/><limit lower="-1.5" upper="1.5" velocity="1"/></joint>'
    '<link name="shoulder"/>'
    '<joint name="roll" type="continuous"><parent link="shoulder"/><child link="upper_arm"/>'
    '<origin xyz="0.1 0 0"/><axis xyz="1 0 0"/></joint><link name="upper_arm"/>'
    '<joint name="mount" type="fixed"><parent link="base_link"/><child link="camera_support"/>'
    '<origin xyz="0.1 0 0.7"/></joint>'
    '<link name="camera_support"><visual><geometry><box size="0.02 0.02 0.02"/></geometry></visual></link></robot>'
)


def drive_of(text: str) -> DriveGeometry:
    return find_drive(parse_urdf(text, "robot.urdf"))


def read(text: str) -> DescriptionReading:
    return read_base_figures(parse_urdf(text, "robot.urdf"), {})


def test_joints_of_an_arm_are_no_casters_and_steer_nothing() -> None:
    text = MESHES.replace("</robot>", ARM)
    assert [contact.link for contact in drive_of(text).casters] == ["rear_wheel_link"]
    assert not any("steers" in note for note in read(text).notes)


def test_revolute_joints_that_turn_without_end_are_wheels() -> None:
    limits = '<limit effort="10" lower="-1e16" upper="1e16" velocity="4.0"/>'
    text = MESHES.replace('type="continuous"', 'type="revolute"').replace('<limit effort="10" velocity="4.0"/>', limits)
    assert [wheel.joint.name for wheel in drive_of(text).wheels] == ["left_wheel", "right_wheel"]
    assert not drive_of(text.replace("1e16", "1.5")).wheels


def test_wheels_that_do_not_turn_are_found_by_their_name_and_shape() -> None:
    text = FOUR_WHEELS.replace("continuous", "fixed")
    drive = drive_of(text)
    assert len(drive.wheels) == 4
    assert {round(wheel.y, 4) for wheel in drive.left} == {0.2854}
    assert read(text).figures["wheel_radius"].value == 0.165
    assert drive.casters == ()
    assert not drive_of(text.replace("wheel", "post")).wheels


def test_driven_wheels_below_swivels_are_found_where_there_are_no_others() -> None:
    forks = "".join(
        f'<joint name="{side}_swivel" type="continuous"><parent link="base_link"/><child link="{side}_fork"/>'
        f'<origin xyz="0 {y} 0"/><axis xyz="0 0 1"/></joint><link name="{side}_fork"/>'
        for side, y in (("left", 0.17), ("right", -0.17))
    )
    text = MESHES.replace("</robot>", f"{forks}</robot>")
    for side, y in (("left", "0.17"), ("right", "-0.17")):
        old = f'<parent link="base_link"/><child link="{side}_wheel_link"/><origin xyz="0 {y} 0"/>'
        assert old in text
        text = text.replace(old, f'<parent link="{side}_fork"/><child link="{side}_wheel_link"/><origin xyz="0 0 0"/>')
    assert [wheel.joint.name for wheel in drive_of(text).wheels] == ["left_wheel", "right_wheel"]


def test_wheel_stands_where_its_shape_is_and_not_where_its_joint_is() -> None:
    beside = FOUR_WHEELS
    for side, y in (("left", 0.05), ("right", -0.05)):
        for end in ("front", "rear"):
            head, tail = beside.split(f'<link name="{end}_{side}_wheel_link">')
            tail = tail.replace('<origin rpy="1.5708 0 0"/>', f'<origin xyz="0.01 {y} 0" rpy="1.5708 0 0"/>', 1)
            beside = f'{head}<link name="{end}_{side}_wheel_link">{tail}'
    figures = read(beside).figures
    assert round(figures["wheel_separation"].value, 4) == 0.6708
    assert {round(wheel.x, 3) for wheel in drive_of(beside).wheels} == {0.256, -0.256}, "it turns about its joint"


def test_robot_that_drives_sideways_becomes_a_base_that_does() -> None:
    plugin = '<gazebo><plugin name="move" filename="libgazebo_ros_planar_move.so"/></gazebo></robot>'
    for text in (MESHES.replace("</robot>", plugin), FOUR_WHEELS.replace("_wheel_link", "_mecanum_link")):
        given = {"velocity": 0.3, "angular_velocity": 1.0}
        reading = read_base_figures(parse_urdf(text, "robot.urdf"), given)
        assert reading.figures["lateral_velocity"].value == 0.3
        assert "\n  lateral_velocity: 0.3 # as ahead" in write_base_file(reading, "A robot.", "robot.urdf")
    receiver = plugin.replace("planar_move", "ir_omni_receiver")
    for text in (SMALL, FOUR_WHEELS, MESHES, MESHES.replace("</robot>", receiver)):
        assert read(text).figures["lateral_velocity"].value == 0.0


def test_outline_covers_what_is_seen_and_what_touches() -> None:
    wide = '<visual><geometry><box size="0.2 0.3 0.1"/></geometry></visual></link>'
    text = SMALL.replace("</inertial>\n  </link>", f"</inertial>{wide}", 1)
    figures = read(text).figures
    assert (figures["length"].value, figures["width"].value) == (0.2, 0.3)
    huge = wide.replace("0.2 0.3", "2.0 3.0")
    kept = read(text.replace(wide, huge)).figures
    assert (kept["length"].value, kept["width"].value) == (0.14, 0.14), "far too large for its wheels"
