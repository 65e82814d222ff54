"""A robot of the bench with a ROS 2 in /opt/ros, a base that a systemd unit runs, and no ROS 1."""

from __future__ import annotations

import fcntl
import hashlib
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.hosts.bench.machine import Machine
from tests.hosts.bench.root import cache_folder

REQUIREMENTS = Path(__file__).resolve().parents[3] / "requirements"
LOCKS = {"jazzy": REQUIREMENTS / "ros2-jazzy.lock", "kilted": REQUIREMENTS / "ros2.lock"}
BASE = Path(__file__).with_name("cmd_vel_base.py")
DOMAIN = 7
PREFIX = "/opt/ros/jazzy"
UNIT = "robot-base.service"
# As ament writes it, in fewer lines. Wheels of ROS 2 restart each Python, unless the last variable is set.
SETUP = """\
export AMENT_PREFIX_PATH={PREFIX} ROS_DISTRO={DISTRO} ROS_VERSION=2 ROS_PYTHON_VERSION=3
export PATH="{PREFIX}/bin:$PATH" _ROS_WHEELS_BOOTSTRAP_COMPLETE=1
for folder in {PREFIX}/lib/python3*/*-packages {PREFIX}/local/lib/python3*/*-packages; do
  if [ -d "$folder" ]; then
    export PYTHONPATH="$folder${PYTHONPATH:+:$PYTHONPATH}"
    LD_LIBRARY_PATH="$(printf '%s:' "$folder"/ros_*.libs)${LD_LIBRARY_PATH:-}"
  fi
done
export LD_LIBRARY_PATH="{PREFIX}/lib:$LD_LIBRARY_PATH"
"""
SERVICE = f"""\
[Unit]
Description=The base of the robot
[Service]
User=ros
RuntimeDirectory=base
Environment=ROS_DOMAIN_ID={DOMAIN} HOME=/home/ros
ExecStart=/bin/bash -c '. {{prefix}}/setup.bash && exec python3 /opt/robot/cmd_vel_base.py {{arguments}}'
Restart=on-failure
[Install]
WantedBy=multi-user.target
"""
UBUNTU = """\
PRETTY_NAME="Ubuntu 24.04 LTS"
ID=ubuntu
ID_LIKE=debian
VERSION_ID="24.04"
VERSION_CODENAME=noble
UBUNTU_CODENAME=noble
"""
GONE = "python3-genpy python3-rosgraph python3-rospy rosout topic-tools catkin '^ros-.*' '^python3-.*-(msgs|srvs)$'"
REMOVE = f"apt-get -q -y purge {GONE} >/dev/null 2>&1"


def install_jazzy(robot: Machine, *arguments: str) -> None:
    """Give it ROS 2 Jazzy, start its base with `arguments`, and remove ROS 1."""
    install_ros2(robot, "jazzy", *arguments)


def install_ros2(robot: Machine, distro: str, *arguments: str) -> None:
    """Give it a release of ROS 2, start its base with `arguments`, and remove ROS 1."""
    remove_ros1(robot)
    prefix = f"/opt/ros/{distro}"
    shutil.copytree(release_folder(distro), robot.root / prefix.lstrip("/"), symlinks=True)
    robot.write("/opt/robot/cmd_vel_base.py", BASE.read_text())
    robot.write(f"/etc/systemd/system/{UNIT}", SERVICE.format(prefix=prefix, arguments=" ".join(arguments)))
    # When the last login of a user ends, systemd removes what her units have in shared memory, unless she may linger.
    robot.write("/var/lib/systemd/linger/ros", "")
    robot.run(f"systemctl daemon-reload && systemctl enable --now {UNIT}").check()
    robot.wait_for("grep -q ready /run/base/log", deadline=60)


def remove_ros1(machine: Machine) -> None:
    """Remove all of ROS 1, and name a release that has none."""
    machine.run(REMOVE, timeout=180)
    machine.run("rm /etc/os-release").check()
    machine.write("/etc/os-release", UBUNTU)  # which packages no ROS 1
    assert not machine.run(
        "command -v roscore rosmaster roslaunch; python3 -c 'import rospy' 2>/dev/null && echo rospy"
    ).out


def release_folder(distro: str) -> Path:
    """The folder of a release, made once for each lock and kept in the cache."""
    base, required = cache_folder(), LOCKS[distro]
    setup = SETUP.replace("{PREFIX}", f"/opt/ros/{distro}").replace("{DISTRO}", distro)
    cache = base.with_name(f"{base.name}-{distro}")
    cache.mkdir(parents=True, exist_ok=True)
    with (cache / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        target = cache / hashlib.sha256(required.read_bytes() + setup.encode()).hexdigest()[:12]
        if target.is_dir():
            return target
        for old in cache.iterdir():
            if old.is_dir():
                shutil.rmtree(old)
        unfinished = Path(tempfile.mkdtemp(prefix="unfinished.", dir=cache))
        words = [
            "install",
            "--quiet",
            "--progress-bar",
            "off",
            "--no-compile",
            "--require-hashes",
            "--only-binary",
            ":all:",
        ]
        words += [
            "--no-deps",
            "--ignore-installed",
            "--no-warn-script-location",
            "--prefix",
            str(unfinished),
            "-r",
            str(required),
        ]
        subprocess.run([sys.executable, "-m", "pip", *words], check=True, timeout=800)
        (unfinished / "setup.bash").write_text(setup)
        unfinished.chmod(0o755)
        unfinished.rename(target)
        return target
