"""The clone in a workspace of ROS 2, built by colcon of the package index: what `ros2 run` and `ros2 launch` find."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.ros_session import ROOT

EXECUTABLES = ("cmd_vel_mux", "lost_detector", "obstacle_stop", "web")
COLCON = (
    "colcon-bash",
    "colcon-cmake",
    "colcon-metadata",
    "colcon-python-setup-py",
    "colcon-recursive-crawl",
    "colcon-ros",
)
COPIED = ("src", "tests", "tools", "ubiquity_launches", "pyproject.toml", "ur")


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the package is installed."""
    workspace = tmp_path_factory.mktemp("workspace")
    pip = [
        str(workspace / "tools/bin/pip"),
        "install",
        "--quiet",
        *COLCON,
        "colcon-library-path",
        "cmake",
        "setuptools<80",
    ]
    subprocess.run([sys.executable, "-m", "venv", workspace / "tools"], check=True, timeout=100)
    if subprocess.run(pip, check=False, timeout=300, capture_output=True).returncode:
        pytest.skip("no package index")
    clone = workspace / "src/ubiquity_launches_clone"
    clone.mkdir(parents=True)
    for name in COPIED:
        (clone / name).symlink_to(ROOT / name)
    environment = {
        "HOME": str(workspace),
        "LC_ALL": "C.UTF-8",
        "PATH": f"{workspace}/tools/bin:/usr/bin:/bin",
        "ROS_VERSION": "2",
    }
    command = [str(workspace / "tools/bin/colcon"), "build", "--base-paths", "src", "--executor", "sequential"]
    done = subprocess.run(
        command, cwd=workspace, env=environment, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert "Traceback" not in done.stderr
    assert sorted(each.name for each in (workspace / "install").iterdir() if each.is_dir()) == ["ubiquity_launches"]
    return workspace / "install/ubiquity_launches"


def run(prefix: Path, script: str, **more: str) -> subprocess.CompletedProcess[str]:
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(prefix), "ROS_VERSION": "2", **more}
    return subprocess.run(
        ["bash", "-c", script], env=environment, capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.timeout(600)
def test_sourced_workspace_has_the_package_in_the_index_of_ament(prefix: Path) -> None:
    found = run(prefix, f"source {prefix.parent}/setup.bash; echo $AMENT_PREFIX_PATH")
    assert found.stdout.strip() == str(prefix), found.stderr
    assert (prefix / "share/ament_index/resource_index/packages/ubiquity_launches").is_file()
    assert (prefix / "share/ubiquity_launches/package.xml").is_file()


def test_executables_and_launch_files_are_where_ros2_looks(prefix: Path) -> None:
    folder = prefix / "lib/ubiquity_launches"
    assert sorted(each.name for each in folder.iterdir()) == sorted(EXECUTABLES)
    assert all(os.access(each, os.X_OK) for each in folder.iterdir())
    launch = sorted(each.name for each in (prefix / "share/ubiquity_launches").rglob("*nav2.launch.xml"))
    assert launch == ["beside_nav2.launch.xml"]  # ros2 launch refuses a name that is found twice
    assert (prefix / "share/ubiquity_launches/bases/magni/base.yaml").is_file()


@pytest.mark.parametrize("name", ["cmd_vel_mux", "lost_detector", "obstacle_stop"])
def test_node_without_a_ros_2_says_so_in_a_line(prefix: Path, name: str) -> None:
    done = run(prefix, f"{prefix}/lib/ubiquity_launches/{name} --ros-args -p base:=magni")
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert "rclpy" in done.stderr
    assert "Traceback" not in done.stderr


def test_web_passes_on_its_own_arguments_only(prefix: Path) -> None:
    done = run(prefix, f"{prefix}/lib/ubiquity_launches/web --help --ros-args -r __node:=web")
    assert done.returncode == 0, done.stderr
    assert "ur web" in done.stdout
