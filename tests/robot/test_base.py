import math
import re
from pathlib import Path

import pytest

from ur.robot.base import SENSORS, Bumper, list_bases, list_variants, load_base, read_base
from ur.source.diagnostic import UserError

PACKAGE = Path(__file__).parents[2] / "ubiquity_launches"
GOOD = (PACKAGE / "bases" / "stage" / "base.yaml").read_text(encoding="utf-8")
UPSTREAM = """driver:
  node: n_motor_node
  package: ubiquity_motor
  executable: motor_node
  device: /dev/ttyAMA0
  baud: 38400
  hardware: pi-uart
  install: clone https://github.com/UbiquityRobotics/ubiquity_motor into a catkin workspace and build it there
"""
# A driver of its makers, with all that its file has to say about one.
MAGNI = re.sub(
    r"^driver: magni.*\n", UPSTREAM, (PACKAGE / "bases" / "magni" / "base.yaml").read_text(encoding="utf-8"), flags=re.M
)
EVERY = [(name, variant) for name in list_bases(PACKAGE) for variant in ("", *list_variants(PACKAGE, name))]


def read_text(tmp_path: Path, text: str, variant: str = "") -> str:
    path = tmp_path / "base.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_base(path, "odd", variant)
    return str(caught.value).replace(str(path), "base.yaml")


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_every_base_of_the_library_is_good(name: str, variant: str) -> None:
    base = load_base(PACKAGE, name, variant)
    assert (base.name, base.variant) == (name, variant)
    area = sum(
        x0 * y1 - x1 * y0
        for (x0, y0), (x1, y1) in zip(base.footprint, (*base.footprint[1:], base.footprint[0]), strict=True)
    )
    assert area > 0, "the footprint goes round counter-clockwise"
    half = base.wheels.separation / 2 + base.wheels.width / 2
    assert max(y for _, y in base.footprint) >= half, "the wheels are inside the footprint"


def test_variant_adds_to_the_plain_base() -> None:
    plain, variant = load_base(PACKAGE, "magni"), load_base(PACKAGE, "magni", "lidar")
    assert plain.lidar is None
    assert variant.lidar is not None
    assert variant.wheels == plain.wheels


def test_unknown_base_names_the_nearest() -> None:
    with pytest.raises(UserError) as caught:
        load_base(PACKAGE, "magnni")
    (finding,) = caught.value.diagnostics
    assert "expected one of" in finding.message
    assert finding.help == "did you mean 'magni'?"


def test_unknown_variant_names_those_there_are() -> None:
    with pytest.raises(UserError, match="variant 'lidr' of base 'magni' is not known, expected one of lidar"):
        load_base(PACKAGE, "magni", "lidr")
    with pytest.raises(UserError, match="'lidar' of base 'stage' is not known, this base has no variants") as caught:
        load_base(PACKAGE, "stage", "lidar")
    assert caught.value.diagnostics[0].help == "leave the variant out for the plain base"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("radius: 0.08", "radius: round", "base.yaml:7:18: radius: 'round' in a base file, wheels, expected a number"),
        ("radius: 0.08", "radius: -1", "expected at least 0.005"),
        ("radius: 0.08", "raduis: 0.08", "radius is missing in a base file, wheels"),
        ("mass: 8.0", "", "mass is missing in a base file, expected a number"),
        ("height: 0.25", "height: 0.25\nheigth: 1", "heigth is not known in a base file"),
        ("height: 0.25", "height: 0.25\nheight: 1", "height is given twice in a base file"),
        ("samples: 360", "samples: 1.5", "samples: 1.5 in a base file, sensors, lidar, expected a whole number"),
        ("footprint: [[", "footprint: [[[", "expected"),
        ("angle_max: 3.12413936", "angle_max: -4", "expected more than angle_min"),
        (
            "range_max: 12.0",
            "range_max: 0.1",
            "range_max: 0.1 in a base file, sensors, lidar, expected more than range",
        ),
        (
            "topic: scan",
            "topic: my scan",
            "topic: 'my scan' in a base file, sensors, lidar, expected a ROS name, as scan",
        ),
        (
            "footprint: [[0.20, 0.15], [0.16, 0.19]",
            "footprint: [[0.16, 0.19], [0.20, 0.15]",
            "footprint in a base file cr",
        ),
        ("frame: imu", "frame: laser", "frame 'laser' in a base file, sensors, imu is taken by lidar"),
        ("frame: imu", "frame: base_link", "frame 'base_link' in a base file, sensors, imu is taken by the body"),
        ("frame: imu", "frame: caster_1", "is the name of a caster"),
        ("frame: imu", "frame: raspicam_body", "is taken by raspicam"),
        ("frame: imu", "frame: i-mu", "expected a name of letters, digits and _"),
        ("gyro_noise: 0.001", "gyro_noise: -1", "gyro_noise: -1 in a base file, sensors, imu, expected at least 0"),
        ("front: [-0.7854, 0.7854]", "front: [0.7854, -0.7854]", "front: [0.7854, -0.7854] in a base file, sensors, b"),
        ("front: [-0.7854, 0.7854]", "front: [0, 9]", "expected the angles from and to of a sector"),
        ("front: [-0.7854, 0.7854]", "front: 1", "expected a list of 2 numbers"),
        ("  imu:", "  cliffs: {at: {}}\n  imu:", "at: no cliff sensor in a base file, sensors, cliffs, expected names"),
        ("  imu:", "  cliffs: {at: {a: [0.1, 0.1]}}\n  imu:", "expected a list of 3 numbers"),
        ("  imu:", "  cliffs: {at: {a: [0, 0, 0.1]}}\n  imu:", "expected a position away from the centre"),
        ("  imu:", "  cliffs: {at: {a: [1, 0, -0.1]}}\n  imu:", "expected a height above the floor"),
        (
            "  imu:",
            "  cliffs: {at: {a-b: [1, 0, 0.1]}}\n  imu:",
            "frame 'cliff_a-b' in a base file, sensors, cliffs",
        ),
        ("technology: lithium-ion", "technology: lithium", "expected one of lead-acid"),
        ("voltage_empty: 12.8", "voltage_empty: 17", "expected less than voltage_full"),
        (
            "current_moving: 2.5",
            "current_moving: 0.5",
            "current_moving: 0.5 in a base file, battery, expected at least",
        ),
        ("design_capacity: 10.0, ", "", "design_capacity is missing in a base file, battery"),
        ("sensors:\n", "sensors:\n  sonar: {}\n", "sonar is not known in a base file, sensors"),
    ],
)
def test_mistake_in_a_base_file_is_placed_and_explained(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert old in GOOD
    message = read_text(tmp_path, GOOD.replace(old, new))
    assert expected in message
    assert message.startswith("base.yaml:")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("body: [[0.07,", "body: [[0.2,", "body in a base file: [0.2, 0.134] is outside the footprint"),
        (
            "body: [[0.07, 0.134], [-0.28, 0.134]",
            "body: [[-0.28, 0.134], [0.07, 0.134]",
            "body in a base file goes",
        ),
        ("sonar_2: [0.08, -0.01,", "sonar_2: [0.08,", "expected a list of 6 numbers"),
        ("sonar_2:", "sonar_1:", "sonar_1 is given twice"),
        ("sonar_2:", "left_wheel:", "frame 'left_wheel' in a base file, sensors, sonars, at is taken by the body"),
        (
            "field_of_view: 0.43632347",
            "field_of_view: 25",
            "field_of_view: 25 in a base file, sensors, sonars, expected 0",
        ),
        ("device: /dev/ttyAMA0", "device: ttyAMA0", "device: 'ttyAMA0' in a base file, driver, expected a device file"),
        ("node: n_motor_node", "node: motor_node", "expected the name of a launch directory, as n_motor_node"),
        ("package: ubiquity_motor", "package: Ubiquity Motor", "expected the name of a ROS package"),
        ("executable: motor_node", "exceutable: motor_node", "executable is missing in a base file, driver"),
        ("baud: 38400", "baud: fast", "baud: 'fast' in a base file, driver, expected a whole number"),
        (
            "drivers:\n  sonars:",
            "drivers:\n  sonar:",
            "sonar in a base file, drivers is no sensor of this base, expected",
        ),
        ("install: clone https://github.com/UbiquityRobotics/ubiquity_motor", "install: ''\n  x:", "expected one line"),
    ],
)
def test_mistake_in_sonars_or_a_driver_is_placed_and_explained(
    tmp_path: Path, old: str, new: str, expected: str
) -> None:
    assert old in MAGNI
    message = read_text(tmp_path, MAGNI.replace(old, new, 1))
    assert expected in message
    assert re.match(r"base\.yaml:\d+:\d+: ", message)


def test_misspelt_key_of_a_driver_is_told_the_right_one(tmp_path: Path) -> None:
    path = tmp_path / "base.yaml"
    path.write_text(MAGNI.replace("  executable: motor_node", "  exceutable: motor_node"), encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_base(path, "odd")
    (finding,) = caught.value.diagnostics
    assert finding.help == "did you mean 'executable' where it says 'exceutable'?"


def test_frame_of_a_cliff_sensor_is_its_own(tmp_path: Path) -> None:
    cliffs = "  cliffs: {at: {front: [0.1, 0, 0.02]}}\n  imu:"
    text = GOOD.replace("frame: imu", "frame: cliff_front").replace("  imu:", cliffs)
    assert "frame 'cliff_front' in a base file, sensors, imu is taken by cliffs" in read_text(tmp_path, text)


def test_driver_of_two_wheels_is_refused_for_a_base_that_drives_sideways(tmp_path: Path) -> None:
    aside = GOOD.replace("command_age:", "lateral_velocity: 0.3, command_age:", 1)
    path = tmp_path / "base.yaml"
    path.write_text(aside, encoding="utf-8")
    assert read_base(path, "odd").limits.lateral_velocity == 0.3
    assert "drives two wheels, expected none" in read_text(
        tmp_path, aside.split("\ndriver:")[0] + "\ndriver: create2\n"
    )


def test_outline_that_goes_round_clockwise_is_refused(tmp_path: Path) -> None:
    text = re.sub(r"footprint: .*", "footprint: [[0.2, -0.2], [-0.2, -0.2], [-0.2, 0.2], [0.2, 0.2]]", GOOD)
    assert "goes round clockwise" in read_text(tmp_path, text)


def test_base_without_sensors_battery_and_driver_is_good(tmp_path: Path) -> None:
    path = tmp_path / "base.yaml"
    path.write_text(GOOD[: GOOD.index("sensors:")], encoding="utf-8")
    base = read_base(path, "plain")
    for part in (*SENSORS, "driver"):
        assert getattr(base, part) is None
    assert base.drivers == ()


def test_variant_takes_a_sensor_away() -> None:
    assert load_base(PACKAGE, "botvac").raspicam
    assert load_base(PACKAGE, "botvac", "xv11").raspicam is None


def test_drivers_name_what_they_drive() -> None:
    base = load_base(PACKAGE, "magni", "lidar")
    assert base.driver is not None
    assert (base.driver.part, base.driver.protocol, base.driver.baud) == ("base", "magni", 38400)
    assert [driver.part for driver in base.drivers] == ["sonars", "raspicam", "lidar"]
    assert load_base(PACKAGE, "botvac", "xv11").drivers == ()


def test_bumpers_of_every_base_that_has_some_cover_its_outline_once() -> None:
    for name, variant in EVERY:
        base = load_base(PACKAGE, name, variant)
        for x, y in base.footprint if base.bumpers else ():
            covering = [bumper.name for bumper in base.bumpers.at if bumper.covers(x, y)]  # type: ignore[union-attr]  # it has some
            assert len(covering) <= 1, (name, covering)
            assert x < 0 or covering, f"{name}: nothing feels a touch in front at {x}, {y}"


@pytest.mark.parametrize(
    ("x", "y", "covered"), [(1.0, 0.0, False), (-1.0, 0.1, True), (-1.0, -0.1, True), (0.0, -1.0, False)]
)
def test_bumper_covers_its_sector_across_the_back(x: float, y: float, covered: bool) -> None:
    assert Bumper("back", 2.8, 3.5).covers(x, y) is covered
    assert Bumper("back", -3.5, -2.8).covers(x, y) is covered


def test_sonars_of_loki_stand_on_its_outline_and_look_out() -> None:
    base = load_base(PACKAGE, "loki")
    assert base.sonars
    assert len(base.sonars.at) == 16
    for sonar in base.sonars.at:
        x, y, z, _, _, yaw = sonar.pose
        ahead = max(px * math.cos(yaw) + py * math.sin(yaw) for px, py in base.footprint)
        assert ahead - (x * math.cos(yaw) + y * math.sin(yaw)) < 0.08, f"{sonar.frame} looks inwards"
        assert 0.0 < z <= base.height


def test_broken_variant_is_found_whichever_is_asked_for(tmp_path: Path) -> None:
    assert "mass: 'much'" in read_text(tmp_path, GOOD + "variants:\n  heavy:\n    mass: much\n")
