"""The node of docs/how-to/write-a-node.md, as it is written there: in its test, and under a launch file."""

import re
import subprocess
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT
from tests.e2e.test_programs import run_command
from tests.ros_session import RosSession

PAGE = (ROOT / "docs" / "how-to" / "write-a-node.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"^```\w+ (\S+)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE))
TEST, START = re.findall(r"^```sh\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """The package my_robot with the files of the page."""
    ur = str(ROOT / "ur")
    made = run_command(
        tmp_path,
        ur,
        "new",
        "package",
        "my_robot",
        "--summary",
        "x",
        "--maintainer",
        "Ada",
        "--email",
        "a@example.org",
        keys="",
    )
    assert made.returncode == 0, made.stderr
    (folder,) = [path.parent for path in tmp_path.rglob("my_robot/package.xml")]
    for name, text in FILES.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def run(package: Path, script: str) -> subprocess.CompletedProcess[str]:
    """In bash, as a reader who types it after `ur env`."""
    (package.parent / "bin").mkdir(exist_ok=True)
    if not (ur := package.parent / "bin" / "ur").exists():
        ur.symlink_to(ROOT / "ur")
    lines = (
        f'PATH="{package.parent}/bin:$PATH"',
        f'export ROS_PACKAGE_PATH="{package}:{ROOT}/ubiquity_launches:/usr/share"',
        f'cd "{package}"',
        script,
    )
    return run_command(package.parent, "bash", "-c", "\n".join(lines), keys="")


def test_node_has_about_forty_lines_and_names_no_middleware() -> None:
    lines = [line for line in FILES["bin/keep_away.py"].splitlines() if line.strip()]
    assert len(lines) <= 42
    assert "ros" not in FILES["bin/keep_away.py"]


@pytest.mark.ros
def test_its_test_passes_on_a_bus(package: Path) -> None:
    done = run(package, TEST)
    assert "3 passed" in done.stdout, done.stdout + done.stderr


@pytest.mark.ros
@pytest.mark.timeout(300)
def test_it_starts_on_ros_with_the_topics_that_it_names(package: Path, tmp_path: Path) -> None:
    session = RosSession(tmp_path / "ros")
    try:
        session.env["ROS_PACKAGE_PATH"] = f"{ROOT}/ubiquity_launches:/usr/share"
        (package / "bin" / "keep_away").chmod(0o755)
        node = session.start(str(package / "bin" / "keep_away"), "_near:=0.5")
        scans = "{angle_min: -0.5, angle_increment: 0.1, range_max: 9.0, ranges: [2.0, 2.0, 2.0]}"
        script = (
            f"rostopic pub -s -r 10 /scan sensor_msgs/LaserScan '{{header: auto, {scans[1:]}' > /dev/null & pub=$!;"
            " rostopic echo -n 1 /cmd_vel/linear/x; kill $pub"
        )
        heard = session.start("bash", "-c", script)
        output, errors = heard.communicate(timeout=120)
        session.running.remove(heard)
        session.stop(node)
    finally:
        session.close()
    assert output.startswith("0.25"), errors


@pytest.mark.ros
@pytest.mark.timeout(400)
def test_launch_file_of_the_page_is_made_and_checked(package: Path) -> None:
    run(package, TEST)
    make = "\n".join(line for line in START.splitlines() if not line.startswith("ur launch"))
    done = run(package, make)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (package / "n_keep_away/launch/n_keep_away.launch.xml").is_file()
    assert (package / "m_keep_away/launch/m_keep_away.launch.xml").is_file()
