"""Synthetic workspaces: packages whose launch files include one another, with the mistakes that such files have."""

import random
from pathlib import Path

FILES_EACH = 3  # launch files of a package that has any
MISTAKE_EVERY = 6  # packages, of which one has a mistake

_MANIFEST = """<package format="2">
  <name>{name}</name>
  <version>1.0.0</version>
  <description>The package {name} of the laboratory.</description>
  <maintainer email="lab@example.com">Laboratory</maintainer>
  <license>BSD</license>
{depends}</package>
"""
_DRIVER = """<launch>
  <arg name="robot" default="robot_{number}"/> <!-- the robot's name -->
  <arg name="machine" default="localhost"/> <!-- the computer of the drivers -->
  <arg name="rate" default="20"/>
  <machine name="localhost" address="localhost"/>
  <group ns="$(arg robot)">
    <node name="base_{number}" pkg="{name}" type="run" machine="$(arg machine)" output="screen" respawn="true">
      <rosparam command="load" file="$(find {name})/config/base.yaml"/>
      <param name="rate" value="$(arg rate)"/>
      <remap from="cmd_vel" to="cmd_vel_{number}"/>
    </node>
    <node name="laser_{number}" pkg="{name}" type="run" args="--port /dev/ttyUSB{number}">
      <param name="frame" value="$(arg robot)_laser"/>
      <remap from="scan" to="scan_{number}"/>
    </node>
{extra}  </group>
</launch>
"""
_TASK = """<launch>
  <arg name="robot"/> <!-- the robot's name -->
  <arg name="map_file" default="$(find {name})/config/base.yaml"/>
  <arg name="use_camera" default="false"/>
  <arg name="speed" default="$(eval 0.5 * 2)"/>
  <include file="$(find {beside})/launch/drivers.launch">
    <arg name="robot" value="$(arg robot)"/>
    <arg name="rate" value="10"/>
  </include>
  <group ns="$(arg robot)/task_{number}">
    <param name="speed" value="$(arg speed)"/>
    <node name="planner" pkg="{name}" type="run" args="$(arg map_file)">
      <rosparam>
        inflation: 0.5
        costs: {{near: 3.0, far: 1.0}}
      </rosparam>
    </node>
    <node name="camera" pkg="{name}" type="run" if="$(arg use_camera)"/>
  </group>
{extra}</launch>
"""
_BRINGUP = """<launch>
  <arg name="robot" default="robot_{number}"/>
  <arg name="simulation" default="$(optenv SIMULATION false)"/>
  <arg name="with_task" default="true"/>
  <include file="$(find {name})/launch/drivers.launch">
    <arg name="robot" value="$(arg robot)"/>
  </include>
  <include file="$(find {beside})/launch/task.launch" if="$(arg with_task)">
    <arg name="robot" value="$(arg robot)"/>
    <arg name="use_camera" value="true"/>
  </include>
  <node name="monitor_{number}" pkg="{name}" type="run" unless="$(arg simulation)"/>
{extra}</launch>
"""
# Each takes a place in one of the three files: drivers, task, bringup.
_MISTAKES = (
    ("", '  <include file="$(find {name})/launch/taks.launch"/>\n', ""),  # misspelt file
    ('    <node name="odom" pkg="{misspelt}" type="run"/>\n', "", ""),  # misspelt package
    ("", "", '  <param name="limit" value="$(arg sped)"/>\n'),  # undeclared argument
    ('    <node name="gps" pkg="vendor_{number}_driver" type="gps_node"/>\n', "", ""),  # package that is not installed
    ("", '  <node name="planer" pkg="{name}" type="rnu"/>\n', ""),  # misspelt program
    ("", "", '  <node name="echo" pkg="{name}" type="run" output="scren"/>\n'),  # no such choice
    ('    <param name="gain" type="double" value="fast"/>\n', "", ""),  # no number
    ("", '  <node name="far" pkg="{name}" type="run" machine="nucc"/>\n', ""),  # undefined machine
)


def make_workspace(source: Path, files: int, packages: int) -> None:
    """Fill a folder with `packages` packages, of which the first hold `files` launch files between them.

    A launch file starts as much in a workspace of any size. Beside the folder, all.launch includes the drivers of every
    package.
    """
    chooser = random.Random(1)
    used = -(-files // FILES_EACH)
    for number in range(packages):
        name = f"package_{number}"
        folder = source / name
        folder.mkdir(parents=True)
        beside = f"package_{chooser.randrange(used)}"
        depends = f"  <exec_depend>{beside}</exec_depend>\n" if number < used else ""
        (folder / "package.xml").write_text(_MANIFEST.format(name=name, depends=depends))
        (folder / "CMakeLists.txt").write_text(f"cmake_minimum_required(VERSION 3.0)\nproject({name})\n")
        if number < used:
            _fill(folder, number, beside, files - number * FILES_EACH)
    includes = "".join(
        f'  <include file="$(find package_{number})/launch/drivers.launch"/>\n' for number in range(used)
    )
    (source.parent / "all.launch").write_text(f"<launch>\n{includes}</launch>\n")


def change_one_file(source: Path) -> None:
    """Edit one launch file, which others include, as a person would: it gains a parameter."""
    path = source / "package_0" / "launch" / "drivers.launch"
    path.write_text(path.read_text().replace("</launch>", '  <param name="edited" value="1"/>\n</launch>'))


def _fill(folder: Path, number: int, beside: str, files: int) -> None:
    name = folder.name
    wrong = _MISTAKES[number // MISTAKE_EVERY % len(_MISTAKES)] if number % MISTAKE_EVERY == 0 else ("", "", "")
    misspelt = name.replace("package", "pakcage")
    program = folder / "scripts" / "run"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\nexec sleep 1000\n")
    program.chmod(0o755)
    (folder / "config").mkdir()
    (folder / "config" / "base.yaml").write_text("".join(f"gain_{each}: {each / 4}\n" for each in range(12)))
    (folder / "launch").mkdir()
    texts = (("drivers", _DRIVER), ("task", _TASK), ("bringup", _BRINGUP))
    for (kind, text), mistake in list(zip(texts, wrong, strict=True))[:files]:
        extra = mistake.format(name=name, number=number, misspelt=misspelt)
        (folder / "launch" / f"{kind}.launch").write_text(
            text.format(name=name, number=number, beside=beside, extra=extra)
        )
