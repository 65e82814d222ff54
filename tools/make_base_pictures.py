"""Make docs/images/bases/<base>[.<variant>].png: each base as RViz shows it, on a screen that nobody sees.

Usage: tools/make_base_pictures.py [--only NAME] [--size 480x360] [OUTPUT]. It needs Xvfb and RViz.

RViz has the configuration of `rviz_robot`, and looks from as far away as the base is large. A variant that looks like
the plain base is left out.
"""

import argparse
import functools
import math
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import numpy.typing as npt
import yaml
from PIL import Image, ImageGrab

from ur.robot.base import Base, list_bases, list_variants, load_base

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tools.pictures import ROOT, end, save, start_screen, wait_until

PACKAGE = ROOT / "ubiquity_launches"
URDFS = PACKAGE / "n_robot_state_publisher" / "urdf"
CONFIG = PACKAGE / "rviz_robot" / "rviz" / "robot.rviz"
LOOKS = ("footprint", "body", "height", "ground_clearance", "wheels", "casters", "lidar", "raspicam", "sonars", "imu")


def main() -> int:
    """Make the pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", nargs="?", type=Path, default=ROOT / "docs" / "images" / "bases")
    parser.add_argument("--only", metavar="NAME", help="only this one: stage, magni.lidar, ...")
    parser.add_argument("--size", default=(480, 360), type=read_size, metavar="480x360", help="in pixels")
    given = parser.parse_args()
    for program in ("Xvfb", "rviz", "rosmaster"):
        if not shutil.which(program):
            print(f"error: {program} is not installed, and RViz cannot be shown without: apt-get install xvfb rviz")
            return 2
    names = [name for name in list_looks() if given.only in (None, name)]
    if not names:
        print(f"error: {given.only} is not known, expected one of {', '.join(list_looks())}")
        return 2
    width, height = given.size
    with tempfile.TemporaryDirectory(prefix="base_pictures_") as folder, ExitStack() as stack:
        env = stack.enter_context(start_screen(Path(folder), width, height))  # RViz remembers things in its home
        env |= {"ROS_HOSTNAME": "localhost", "ROS_HOME": folder, "ROS_LOG_DIR": f"{folder}/log"}
        env |= {"ROS_PACKAGE_PATH": str(PACKAGE)}
        for name in names:
            with start_master(env) as own:
                picture = take_picture(name, Path(folder), own, (width, height))
            path = given.output / f"{name}.png"
            save(picture, path)
    return 0


def read_size(text: str) -> tuple[int, int]:
    """`480x360`. Raises ArgumentTypeError."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(f"{text!r}, expected WIDTHxHEIGHT, as 480x360")
    return int(width), int(height)


def list_looks() -> dict[str, Base]:
    """`<base>[.<variant>]` of everything that looks different."""
    looks: dict[str, Base] = {}
    for name in list_bases(PACKAGE):
        plain = looks[name] = load_base(PACKAGE, name)
        for variant in list_variants(PACKAGE, name):
            base = load_base(PACKAGE, name, variant)
            if any(getattr(base, part) != getattr(plain, part) for part in LOOKS):
                looks[f"{name}.{variant}"] = base
    return looks


@contextmanager
def start_master(env: dict[str, str]) -> Iterator[dict[str, str]]:
    """A ROS master; the environment in which nodes find it."""
    for _ in range(5):  # until nobody else has taken the port meanwhile
        with socket.socket() as probe:
            probe.bind(("localhost", 0))
            port = probe.getsockname()[1]
        own = env | {"ROS_MASTER_URI": f"http://localhost:{port}"}
        command = ["rosmaster", "--core", "-p", str(port)]
        master = subprocess.Popen(command, env=own, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            wait_until(functools.partial(has_started, master, port), "the ROS master")
            if master.poll() is None:
                yield own
                return
        finally:
            end(master)
    raise SystemExit("error: no ROS master could be started, expected a free port")


def has_started(master: subprocess.Popen[bytes], port: int) -> bool:
    """Whether it answers, or has ended."""
    return master.poll() is not None or is_open(port)


def take_picture(name: str, folder: Path, env: dict[str, str], size: tuple[int, int]) -> Image.Image:
    """What RViz draws of one base, once it does not change any more."""
    base = list_looks()[name]
    config = folder / f"{name}.rviz"
    config.write_text(yaml.safe_dump(make_config(base, {"Width": size[0], "Height": size[1]})), encoding="utf-8")
    joints = "{header: auto, name: [left_wheel_joint, right_wheel_joint], position: [0, 0], velocity: [], effort: []}"
    urdf = URDFS / f"{name}.urdf"
    commands = [
        ["/usr/bin/rosrun", "robot_state_publisher", "robot_state_publisher"],
        ["/usr/bin/rostopic", "pub", "-s", "-r", "5", "joint_states", "sensor_msgs/JointState", joints],
        ["rviz", "--fullscreen", "-d", str(config), "-s", ""],
    ]
    subprocess.run(["/usr/bin/rosparam", "set", "robot_description", "-t", str(urdf)], env=env, check=True)
    log = folder / f"{name}.log"
    with log.open("wb") as output:
        running = [
            subprocess.Popen(command, env=env, stdout=output, stderr=output, start_new_session=True)
            for command in commands
        ]
        try:
            pictures: list[npt.NDArray[np.uint8]] = []

            def is_ready() -> bool:
                for process, command in zip(running, commands, strict=True):
                    if process.poll() is not None:
                        tail = "\n".join(log.read_text(errors="replace").splitlines()[-12:])
                        raise SystemExit(
                            f"error: {command[0]} has ended ({process.returncode}), expected it to run on\n{tail}"
                        )
                return is_drawn(pictures, env["DISPLAY"])

            wait_until(is_ready, f"a picture of {name}")
            return Image.fromarray(pictures[-1])
        finally:
            for process in running:
                end(process)


def make_config(base: Base, window: dict[str, int]) -> dict[str, object]:
    """The configuration of `rviz_robot`, with nothing but the view, from as far away as the base is large."""
    config: dict[str, object] = yaml.safe_load(CONFIG.read_text(encoding="utf-8"))
    xs, ys = zip(*base.footprint, strict=True)
    top = max(base.height, base.lidar.pose[2] if base.lidar else 0.0)
    size = math.dist((min(xs), min(ys), 0.0), (max(xs), max(ys), top))
    manager = config["Visualization Manager"]
    assert isinstance(manager, dict)
    manager["Views"]["Current"] |= {
        "Distance": 1.45 * size,
        "Focal Point": {"X": (min(xs) + max(xs)) / 2.0, "Y": 0.0, "Z": 0.45 * top},
    }
    config["Window Geometry"] = {"Hide Left Dock": True, "Hide Right Dock": True, "X": 0, "Y": 0} | window
    return config


def is_drawn(pictures: list[npt.NDArray[np.uint8]], display: str) -> bool:
    """Look at the screen; whether it has shown the same five times, and a whole robot."""
    time.sleep(0.3)
    pictures.append(np.asarray(ImageGrab.grab(xdisplay=display).convert("RGB")))
    last = pictures[-5:]
    if len(last) < 5 or any((picture != last[0]).any() for picture in last[1:]):
        return False
    if (last[0] == 255).all(axis=2).any():  # what has no frame yet is white
        return False
    red, blue = last[0][..., 0].astype(int), last[0][..., 2].astype(int)
    return bool((blue > red + 40).mean() > 0.05)  # the body is blue


def is_open(port: int) -> bool:
    """Whether somebody listens."""
    with socket.socket() as probe:
        return probe.connect_ex(("localhost", port)) == 0


if __name__ == "__main__":
    sys.exit(main())
