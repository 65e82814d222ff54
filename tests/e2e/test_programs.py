"""The programs as people start them: piped commands, wrong input, and nothing left behind."""

import os
import subprocess
from pathlib import Path

import psutil
import pytest
from PIL import Image, ImageDraw
from tests.e2e.conftest import ROOT, make_environment
from tests.office_fiducials import write_office_map
from tests.ur_nodes.simulator.renderer import needs_renderer

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]


def run_program(
    folder: Path, program: str, *arguments: str, keys: str, more: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """`ur run` to the end with piped input and `more` variables; fails when a process of it is left."""
    return run_command(folder, str(ROOT / "ur"), "run", program, *arguments, keys=keys, more=more)


def run_command(
    folder: Path, *command: str, keys: str, more: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    env = make_environment(folder)
    env["PATH"] = f"{ROOT / 'ubiquity_launches' / 'bin'}:{env['PATH']}"  # as `ur env` does
    env |= more or {}
    done = subprocess.run(
        command, env=env, input=keys, capture_output=True, text=True, timeout=150, cwd=folder, check=False
    )
    left = [p for p in psutil.process_iter(["environ"]) if mentions(p, env["ROS_MASTER_URI"])]
    assert not left, f"still running: {left}"
    assert "Traceback" not in done.stdout + done.stderr
    return done


def mentions(process: psutil.Process, address: str) -> bool:
    return (process.info["environ"] or {}).get("ROS_MASTER_URI") == address


def test_piped_goals_are_driven_one_after_the_other_and_one_that_fails_makes_the_exit_code_one(
    tmp_path: Path, either_ros: dict[str, str]
) -> None:
    keys = "g 0.8 0 0\ng 2 x\ng 0 100\ng 1.5 0 180\n"
    done = run_program(tmp_path, "keyboard_navigate", keys=keys, more=either_ros)
    first, outside, second = done.stdout.splitlines()
    assert first.startswith("g 0.8 0 0: reached, ")
    assert "outside the map" in outside
    assert second.startswith("g 1.5 0 180: reached, ")
    assert "'x' is not a number" in done.stderr
    assert done.returncode == 1


def test_shell_that_has_sourced_ros_2_drives_the_robot(tmp_path: Path) -> None:
    ros2 = tmp_path / "humble"
    packages = ros2 / "lib" / "python3.10" / "site-packages"
    for name in ("geometry_msgs", "sensor_msgs", "std_msgs"):
        (packages / name).mkdir(parents=True)
        (packages / name / "__init__.py").write_text("raise ImportError('of ROS 2')\n")
    more = {"AMENT_PREFIX_PATH": str(ros2), "PYTHONPATH": str(packages), "ROS_VERSION": "2", "ROS_DISTRO": "humble"}
    command = (str(ROOT / "ur"), "run", "keyboard_navigate")
    done = run_command(tmp_path, *command, keys="g 1 0.5\n", more=more)
    assert done.stdout.startswith("g 1 0.5: reached, "), done.stderr


def test_create_2_is_driven_through_its_drivers_and_stand_ins_on_either_ros(
    tmp_path: Path, either_ros: dict[str, str]
) -> None:
    arguments = ("robot_base:=create2", "robot_variant:=lidar", "simulate:=devices")
    more = {**either_ros, "USER": f"e2e{os.getpid()}"}  # names the folder of the devices
    done = run_program(tmp_path, "keyboard_navigate", *arguments, keys="g 0.8 0 0\n", more=more)
    assert done.stdout.startswith("g 0.8 0 0: reached, "), done.stderr
    assert done.returncode == 0


def test_magni_with_a_lidar_navigates_in_the_office(tmp_path: Path) -> None:
    arguments = ("robot_base:=magni", "robot_variant:=lidar", "world:=office")
    done = run_program(tmp_path, "keyboard_navigate", *arguments, keys="g 1 0 0\n")
    assert done.stdout.startswith("g 1 0 0: reached, "), done.stderr
    assert done.returncode == 0


def test_goals_are_driven_in_a_world_made_from_a_picture(tmp_path: Path) -> None:
    image = Image.new("L", (400, 300), 255)
    ImageDraw.Draw(image).line((250, 0, 250, 200), fill=0, width=2)  # a wall between the start and the goal
    image.save(tmp_path / "plan.png")
    made = run_command(
        tmp_path, str(ROOT / "ur"), "new", "world", "home", "--picture", "plan.png", "--width", "10", keys=""
    )
    assert made.returncode == 0, made.stderr
    done = run_program(tmp_path, "keyboard_navigate", "world:=./home.yaml", keys="g 2.5 0\ng 0 40\n")
    first, second = done.stdout.splitlines()
    assert first.startswith("g 2.5 0: reached, "), done.stderr
    assert "outside the map" in second


def test_master_set_by_hand_on_this_computer_means_the_simulated_robot(tmp_path: Path) -> None:
    selected = run_command(tmp_path, str(ROOT / "ur"), "use", "--away", "bob:magni:lidar", keys="")
    assert selected.returncode == 0
    done = run_program(tmp_path, "keyboard_navigate", keys="g 1 0 0\n")
    assert "was set by hand: using sim:magni:lidar with that master, not bob:magni:lidar" in done.stderr
    assert done.stdout.startswith("g 1 0 0: reached, ")
    assert done.returncode == 0


def test_programs_of_a_package_on_the_path_run_by_their_names(tmp_path: Path) -> None:
    folder = tmp_path / "robots" / "my_robot" / "bin"
    folder.mkdir(parents=True)
    (folder.parent / "package.xml").write_text("<package><name>my_robot</name></package>")
    (folder / "ur_greet").write_text('#!/bin/sh\n##Summary: Greet.\necho "hello $*"\n')
    (folder / "ur_greet").chmod(0o755)
    env = f"ROS_PACKAGE_PATH={tmp_path / 'robots'}"
    done = run_command(tmp_path, "env", env, str(ROOT / "ur"), "run", "greet", "to:=you", keys="")
    assert (done.stdout, done.stderr, done.returncode) == ("hello to:=you\n", "", 0)


def test_magni_without_a_lidar_navigates_by_fiducials_that_were_mapped_before(tmp_path: Path) -> None:
    needs_renderer()
    arguments = ("robot_base:=magni", f"fiducial_map:={write_office_map(tmp_path / 'fiducials.txt')}")
    done = run_program(tmp_path, "keyboard_navigate", *arguments, keys="g 1 0 0\n")
    assert done.stdout.startswith("g 1 0 0: reached, "), done.stderr
    assert done.returncode == 0


def test_same_launch_file_works_under_plain_roslaunch(tmp_path: Path) -> None:
    arguments = ("robot_base:=stage", "use_rviz:=false")
    done = run_command(
        tmp_path,
        *("roslaunch", "ubiquity_launches", "m_keyboard_navigate.launch.xml", *arguments),
        keys="g 1.5 0 90\n",
    )
    assert "g 1.5 0 90: reached, " in done.stdout


def test_program_is_found_by_rosrun(tmp_path: Path) -> None:
    done = run_command(tmp_path, "rosrun", "ubiquity_launches", "keyboard_navigate", keys="g 1 0 0\n")
    assert done.stdout.startswith("g 1 0 0: reached, "), done.stderr
    assert done.returncode == 0


def test_keyboard_drive_takes_keys_from_a_pipe(tmp_path: Path) -> None:
    assert run_program(tmp_path, "keyboard_drive", "robot_base:=magni", keys="iik").returncode == 0


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["robot_base:=magnni"], "did you mean 'magni'?"),
        (["robot_base:=magni", "robot_variant:=lidr"], "did you mean 'lidar'?"),
        (["robot_base:=magni"], "there is no map of fiducials for its camera"),
        (["robot_base:=botvac", "localisation:=fiducal"], "did you mean 'fiducials'?"),
        (["robot_bse:=magni"], "unknown argument 'robot_bse'"),
        (["office"], "expected NAME:=VALUE"),
        (["world:=mazze"], "did you mean"),
        (["map_file:=/nowhere/map.yaml"], "map file '/nowhere/map.yaml' does not exist"),
    ],
)
def test_wrong_argument_ends_the_program_with_a_clear_line(tmp_path: Path, arguments: list[str], expected: str) -> None:
    done = run_program(tmp_path, "keyboard_navigate", *arguments, keys="g 1 0\n")
    assert expected in done.stderr
    assert done.returncode in (1, 2)


def test_broken_map_is_named_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "odd.yaml"
    path.write_text("image: odd.png\nresolution: fine\n", encoding="utf-8")
    done = run_program(tmp_path, "keyboard_navigate", f"map_file:={path}", keys="g 1 0\n")
    assert f"{path}:2:13: error: resolution: 'fine' in a map file, expected a number" in done.stderr
    assert done.returncode == 1
