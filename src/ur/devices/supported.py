"""Robots and sensors, what one command brings for each, and how that was tried."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Way = Literal["stand-in", "simulator", "description", "upstream driver", "hardware"]
_CONTRACT = "tests/data/test_drivers.py::test_drivers_publish_what_the_simulated_base_publishes"


@dataclass(frozen=True, slots=True)
class Trial:
    """Something that was tried: in which way, and the test that does it, as FILE::FUNCTION of the repository."""

    way: Way
    subject: str
    test: str


@dataclass(frozen=True, slots=True)
class Supported:
    """A robot or sensor.

    `devices` are names of the table of known devices, `bases` those of base files (BASE or BASE:VARIANT). `brings` is
    what `command` leaves ready, `by_hand` the rest. `untried` names what was never tried, never ''. `drives` are drives
    of `bench/navigation` in the simulator that no test repeats; '' where there are none.
    """

    name: str
    command: str
    brings: str
    by_hand: str
    untried: str
    devices: tuple[str, ...] = ()
    bases: tuple[str, ...] = ()
    trials: tuple[Trial, ...] = ()
    drives: str = ""


_DRIVERS = Trial("simulator", "the same topics as its drivers, by their launch files", _CONTRACT)
_URDF = "a description of this kind, written for the test, is read"
_FAULTS = "tests/ur_nodes/drivers/test_device_faults.py"
_JOYSTICK = "tests/ur_nodes/motion/joystick/test_joystick_nodes.py"
_CAMERA = "tests/ur_nodes/camera/test_raspicam_node.py"
_NO_HARDWARE = "the device itself; its driver"

SUPPORTED: tuple[Supported, ...] = (
    Supported(
        "Ubiquity Robotics Magni",
        "`ur robot setup`",
        "groups, udev rules, launch files, description, simulated base",
        "build the drivers of the motors and sonars: `ur get ubiquity_motor pi_sonar` prints the commands",
        "the robot itself; `ubiquity_motor`; `pi_sonar`",
        ("pi-uart",),
        ("magni",),
        (
            Trial(
                "stand-in",
                "protocol of the motor board, noise, old firmware",
                "tests/devices/test_stand_ins.py::test_motor_board_answers_reads_keeps_writes_and_ignores_noise",
            ),
            Trial(
                "stand-in",
                "a question for another device moves no motor",
                "tests/devices/test_stand_ins.py::test_question_for_a_lidar_moves_no_motor",
            ),
            Trial(
                "stand-in",
                "`driver_adapter` behind a small driver of the test: noise, unplugged and back, a broken counter",
                f"{_FAULTS}::test_wheels_turn_by_the_ticks_of_the_motor_board_and_not_by_its_faults",
            ),
            _DRIVERS,
        ),
    ),
    Supported(
        "Ubiquity Robotics Loki",
        "`ur robot setup`",
        "groups, udev rules, launch files, description, simulated base",
        "build its driver: `ur get loki_base_node` prints the commands, of its last release, for ROS Kinetic",
        "the robot itself; `loki_base_node`",
        ("pi-uart",),
        ("loki",),
        (_DRIVERS,),
    ),
    Supported(
        "Neato Botvac",
        "`ur robot setup`",
        "groups, the name `/dev/neato`, launch files, description, simulated base",
        "build its driver: `ur get neato_node` prints the commands",
        "the robot itself; `neato_node`",
        ("neato",),
        ("botvac", "botvac:botvac50"),
        (
            Trial(
                "stand-in",
                "its answer to GetVersion",
                "tests/devices/test_probe.py::test_neato_names_its_model_and_software",
            ),
            _DRIVERS,
        ),
    ),
    Supported(
        "Neato XV-11, or its lidar alone",
        "`ur robot setup`",
        "groups, the name `/dev/neato`, launch files, description, simulated base",
        "build its driver: `ur get neato_node` (the lidar alone: `ur get xv_11_laser_driver`) prints the commands",
        "the robot itself; `neato_node`; `xv_11_laser_driver`",
        ("neato", "xv11-lidar"),
        ("botvac:xv11",),
        (
            Trial(
                "stand-in",
                "packets of the lidar, wrong checksums",
                "tests/devices/test_stand_ins.py::test_xv11_is_recognised_by_packets_whose_checksum_is_right",
            ),
            Trial(
                "stand-in",
                "another speed of the line",
                "tests/devices/test_stand_ins.py::test_device_at_another_speed_is_not_recognised_and_not_mistaken",
            ),
            Trial(
                "stand-in",
                "`driver_adapter` behind a small driver of the test: unplugged and back",
                f"{_FAULTS}::test_scan_stops_with_the_unplugged_lidar_and_goes_on_when_it_is_back",
            ),
            Trial(
                "stand-in",
                "likewise: old firmware, another speed of the line",
                f"{_FAULTS}::test_lidar_that_is_not_understood_gives_no_scan_until_another_one_is_plugged_in",
            ),
            _DRIVERS,
        ),
    ),
    Supported(
        "Robotis TurtleBot3",
        "`ur new base burger --from FILE`",
        "a simulated base from the description of its makers; its boards by their USB ids in `ur devices`",
        "answer how fast it drives; build its driver: `ur get turtlebot3_bringup`; write its `driver` and launch file",
        "the robot itself; `turtlebot3_bringup`",
        ("opencr", "lds-01"),
        (),
        (
            Trial(
                "description",
                _URDF,
                "tests/robot/description/test_reading.py::test_small_robot_is_read_from_its_shapes_and_gazebo_tags",
            ),
        ),
        "burger: 10 of 10 goals in the maze",
    ),
    Supported(
        "Clearpath Husky",
        "`ur new base husky --from FILE --lidar`",
        "a simulated base from the description of its makers",
        "answer how fast it drives; build its driver: `ur get husky_base`; write its `driver` and launch file",
        "the robot itself; `husky_base`",
        (),
        (),
        (
            Trial(
                "description",
                _URDF,
                "tests/robot/description/test_reading.py::"
                "test_skid_steer_has_its_wheels_between_the_axles_and_supports_below_them",
            ),
        ),
        "5 to 7 of 10 goals in the office: it is long for its doors",
    ),
    Supported(
        "Pioneer 3-DX",
        "`ur new base p3dx --from FILE`",
        "a simulated base from a description of it",
        "answer what the description does not say; build a driver of your choice; write its `driver` and launch file",
        "the robot itself; its driver",
        (),
        (),
        (
            Trial(
                "description",
                _URDF,
                "tests/robot/description/test_reading.py::test_meshes_take_their_size_from_the_inertia_and_speeds_come_from_joints",
            ),
        ),
        "10 of 10 goals in the maze",
    ),
    Supported(
        "Slamtec RPLIDAR A1, A2, A3",
        "`ur robot setup`, on a robot whose base has it",
        "group, the name `/dev/rplidar`, recognised by its answer, launch file `n_rplidar`",
        "build its driver: `ur get rplidar_ros` prints the commands",
        "the lidar itself; `rplidar_ros`",
        ("rplidar",),
        ("magni:lidar",),
        (
            Trial(
                "stand-in",
                "its answer behind noise, old firmware",
                "tests/devices/test_stand_ins.py::test_rplidar_is_recognised_with_old_firmware_and_behind_noise",
            ),
            Trial(
                "stand-in",
                "unplugged and back",
                "tests/devices/test_stand_ins.py::test_unplugged_device_is_reported_and_recognised_again_when_it_is_back",
            ),
            Trial(
                "stand-in",
                "`ur devices`: noise, old firmware, another speed of the line",
                "tests/cli/robots/test_devices.py::"
                "test_lidar_with_a_fault_is_named_by_its_answer_or_said_not_to_answer",
            ),
            Trial(
                "stand-in",
                "`ur devices`: unplugged, and back behind another device file",
                "tests/cli/robots/test_devices.py::"
                "test_unplugged_lidar_is_missing_and_ready_again_behind_another_device_file",
            ),
            Trial(
                "stand-in",
                "the doctor's rules: unplugged, and back behind another device file",
                "tests/robot/doctor/rules/test_plugged_devices.py::"
                "test_doctor_follows_a_lidar_that_is_unplugged_and_back_behind_another_file",
            ),
        ),
    ),
    Supported(
        "YDLIDAR X4",
        "`ur get ydlidar_ros_driver`",
        "the commands that fetch and build its driver; a guess in `ur devices`, since its chip is a common one",
        "build YDLIDAR's own library and the driver; write its launch file",
        _NO_HARDWARE,
        ("ydlidar",),
    ),
    Supported(
        "Hokuyo URG, UTM",
        "`ur get urg_node`",
        "the commands that fetch and build its driver",
        "build the driver; write its launch file",
        _NO_HARDWARE,
        ("hokuyo",),
    ),
    Supported(
        "Raspberry Pi camera 2, 3",
        "`ur run raspicam`",
        "pictures, camera_info, calibration; it names the package that is missing",
        "the ribbon; `python3-picamera2` of Raspberry Pi OS",
        "the camera itself; libcamera and picamera2 themselves",
        (),
        ("magni", "loki", "botvac"),
        (
            Trial(
                "stand-in",
                "pictures of picamera2's interface, and its end",
                "tests/ur_nodes/camera/test_libcamera.py::"
                "test_pictures_of_libcamera_arrive_and_its_process_ends_with_the_camera",
            ),
        ),
    ),
    Supported(
        "USB camera",
        "`ur run raspicam`",
        "pictures, as JPEG where the camera gives it, camera_info, calibration",
        "nothing",
        "a camera itself; the kernel's structures are compared with its header",
        ("logitech-camera", "ps-eye"),
        (),
        (
            Trial(
                "stand-in",
                "V4L2: unplugged and back",
                f"{_CAMERA}::test_pictures_go_on_after_the_camera_was_unplugged",
            ),
            Trial(
                "stand-in",
                "V4L2: paused for other programs",
                f"{_CAMERA}::test_camera_that_is_not_captured_is_free_for_other_programs",
            ),
            Trial(
                "stand-in",
                "two cameras",
                f"{_CAMERA}::test_two_nodes_of_two_cameras_publish_side_by_side",
            ),
            Trial(
                "stand-in",
                "the screen of its calibration",
                "tests/e2e/test_calibrate_camera.py::"
                "test_screen_names_the_missing_camera_and_calibrates_the_one_that_is_plugged_in",
            ),
        ),
    ),
    Supported(
        "Intel RealSense D435",
        "`ur get realsense2_camera`",
        "the commands that fetch and build its driver; its name in `ur devices`",
        "install librealsense; build the driver; write its launch file",
        "the camera itself, also as a V4L2 camera; `realsense2_camera`",
        ("realsense",),
    ),
    Supported(
        "u-blox 7 or 8 GNSS receiver",
        "`ur get ublox_gps`",
        "the commands that fetch and build its driver",
        "build the driver; write its launch file",
        _NO_HARDWARE,
        ("gps",),
    ),
    Supported(
        "Bosch BNO055 inertial unit",
        "none",
        "nothing: on I2C it has no id by which it could be found",
        "build a driver of your choice; write its launch file",
        _NO_HARDWARE,
    ),
    Supported(
        "Joystick or gamepad",
        "`ur run joystick_teleop`",
        "driving, with a button that has to be held and one that stops; its name in `ur devices`",
        "nothing",
        "a joystick itself",
        ("xbox-360", "xbox-one", "f310", "f710", "dualshock-4", "dualsense"),
        (),
        (
            Trial(
                "stand-in",
                "driving while the button is held",
                "tests/ur_nodes/motion/test_motion_nodes.py::test_joystick_drives_while_its_dead_man_button_is_held",
            ),
            Trial(
                "stand-in",
                "unplugged while it drives",
                f"{_JOYSTICK}::test_reader_publishes_changes_and_repeats_and_lets_go_when_the_device_is_gone",
            ),
        ),
    ),
    Supported(
        "Sonars (HC-SR04) on Magni's board",
        "`ur robot setup`",
        "launch file `n_pi_sonar`, description, simulated sonars",
        "build the driver: `ur get pi_sonar` prints the commands",
        "the sonars themselves; `pi_sonar`",
        (),
        ("magni",),
        (_DRIVERS,),
    ),
)
"""The table, in its order on the page."""
