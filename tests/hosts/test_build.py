"""`ur build`: a package that is built and runs on both computers, and builds that are interrupted or cannot be."""

import pytest
from tests.hosts.bench import UR, Bench, Done, wait_until
from tests.hosts.test_doctor import pair

__all__ = ["pair"]
PACKAGE = """\
<package format="2">
  <name>{name}</name><version>1.0.0</version><description>For a test.</description>
  <maintainer email="nobody@example.com">nobody</maintainer><license>MIT</license>
  <buildtool_depend>catkin</buildtool_depend>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.5)
project({name})
find_package(catkin REQUIRED)
catkin_package()
{more}
"""
CODE = '#include <iostream>\nint main() { std::cout << "built" << std::endl; }\n'
SLOW = "add_custom_target({name}_slow ALL COMMAND echo begun COMMAND sleep 600)"
BAD = "add_executable(wrong wrong.cpp)"


def add_package(pair: Bench, name: str, more: str, **files: str) -> None:
    texts = {"package.xml": PACKAGE.format(name=name), "CMakeLists.txt": CMAKE.format(name=name, more=more), **files}
    for path, text in texts.items():
        target = f"catkin_ws/src/{name}/{path}"
        pair["laptop"].run(f"mkdir -p catkin_ws/src/{name} && cat >{target}", user="pat", stdin=text).check()


def build(pair: Bench, *words: str) -> Done:
    return pair["laptop"].run(f"{UR} build {' '.join(words)}", user="pat", timeout=300)


@pytest.fixture
def workspaces(pair: Bench) -> Bench:
    """Both hold the package `tool`, and nothing is built."""
    for machine, user in (("laptop", "pat"), ("robot", "ros")):
        pair[machine].run("cd catkin_ws && rm -rf build devel .catkin_tools src/*", user=user).check()
    tool = "add_executable(tool tool.cpp)\ncatkin_install_python(PROGRAMS say.py DESTINATION bin)"
    add_package(pair, "tool", tool, **{"tool.cpp": CODE, "say.py": "#!/usr/bin/env python3\nprint('said')\n"})
    pair["laptop"].run("chmod +x catkin_ws/src/tool/say.py", user="pat").check()
    carry(pair)
    return pair


def carry(pair: Bench) -> None:
    pair["laptop"].run(f"{UR} sync bob --yes", user="pat").check()


def test_same_package_is_built_and_runs_on_both_computers(workspaces: Bench) -> None:
    for machine, user, words in (("laptop", "pat", ()), ("robot", "ros", ("bob",))):
        done = build(workspaces, *words).check()
        assert "Built target tool" in done.out
        # New shells know what was built: ~/.ros_setup reads devel/setup.sh.
        said = (
            workspaces[machine]
            .run("$(catkin_find tool tool) && $(catkin_find tool say.py) && cd catkin_ws && ls", user=user)
            .check()
        )
        assert said.out.split() == ["built", "said", "build", "devel", "src"]
    # What catkin fills in does not keep shells from following the selection.
    laptop = workspaces["laptop"]
    laptop.run(f"{UR} use bob", user="pat").check()
    assert laptop.run("echo $ROS_MASTER_URI", user="pat").out == "http://bob.local:11311\n"
    # Carrying on: what was built stays where it was built, and so does what catkin made for itself.
    done = laptop.run(f"{UR} sync bob --dry-run", user="pat").check()
    assert done.out == "in step with bob\n"


def test_one_package_is_built_by_name(workspaces: Bench) -> None:
    add_package(workspaces, "wrong", BAD, **{"wrong.cpp": "this is no C++"})
    carry(workspaces)
    assert "Built target tool" in build(workspaces, "bob", "--packages", "tool").check().out
    assert build(workspaces, "bob", "--packages", "nothing").code != 0


def test_failing_build_shows_why_and_hands_its_code_on(workspaces: Bench) -> None:
    add_package(workspaces, "wrong", BAD, **{"wrong.cpp": "this is no C++"})
    carry(workspaces)
    for words in ((), ("bob",)):
        done = build(workspaces, *words)
        assert done.code not in (0, 2, 255)
        assert "wrong.cpp" in done.out + done.err
        assert "Traceback" not in done.err


@pytest.mark.parametrize("strike", ["SIGINT", "SIGKILL"])
@pytest.mark.parametrize("where", ["", "bob"])
def test_interrupted_build_leaves_nothing_running(workspaces: Bench, where: str, strike: str) -> None:
    add_package(workspaces, "slow", SLOW.format(name="slow"))
    carry(workspaces)
    laptop = workspaces["laptop"]
    machine, user = (workspaces["robot"], "ros") if where else (laptop, "pat")
    process = laptop.spawn(f"echo $$; exec {UR} build {where}", user="pat")
    assert process.stdout
    number = int(process.stdout.readline())
    with process.stdout:
        for line in process.stdout:  # it comes as it is said: the build is not at its end
            if line.strip() == "begun":
                break
        machine.wait_for(f"pgrep -u {user} -x sleep", user=user)
        laptop.run(f"kill -{strike} {number}").check()
        said = process.stdout.read()
    wait_until(lambda: process.poll() is not None, "the build ends", 60)
    machine.wait_for(f"! pgrep -u {user} 'make|sleep|cmake'", deadline=60)
    if strike == "SIGINT":
        assert process.returncode == 130
        assert "the build was ended" in said
    assert "Traceback" not in said


def test_missing_tools_and_an_empty_workspace_are_named(workspaces: Bench) -> None:
    robot = workspaces["robot"]
    robot.run("mv /usr/bin/catkin_make /usr/bin/away").check()
    done = build(workspaces, "bob")
    robot.run("mv /usr/bin/away /usr/bin/catkin_make; rm -r /home/ros/catkin_ws/src/*").check()
    assert done.code == 2
    assert "sudo apt-get install catkin" in done.err
    done = build(workspaces, "bob")
    assert done.code == 2
    assert "holds no package" in done.err
