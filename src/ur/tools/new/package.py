"""A package for launch files, a base in one, and the first script of a user."""

import json
from xml.sax.saxutils import escape as escape_text

from ur.tools.new.parts import BaseRequest, NewFile

_SCRIPT = '''"""{summary}"""

from ur_nodes.client import Refused, Robot

with Robot() as robot:
    here = robot.pose()
    print(f"the robot is at {{here.x:.2f}} {{here.y:.2f}} m; {{robot.nearest(width=40):.2f}} m are free ahead")
    try:
        there = robot.go_to(here.x + 0.5, here.y)
    except Refused as reason:
        print(f"not driven: {{reason}}")
    else:
        print(f"the robot is at {{there.x:.2f}} {{there.y:.2f}} m")
'''


def plan_script(name: str, summary: str) -> tuple[NewFile, ...]:
    """Plan a script that drives half a metre; `summary` is its purpose, in one line."""
    text = " ".join(summary.split()).replace("\\", "").replace('"', "'")
    return (NewFile(f"{name}.py", _SCRIPT.format(summary=f"{text.rstrip('.')}.")),)


_PACKAGE = """\
<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>{summary}</description>
  <maintainer email="{email}">{maintainer}</maintainer>
  <license>BSD</license>
  <buildtool_depend>catkin</buildtool_depend>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.10)
project({name} NONE)
find_package(catkin REQUIRED)
catkin_package()
"""
_BIN = """\
# Programs of {name}

Nodes and programs of this package, each executable (`chmod +x`).
`ur run NAME` starts the program `ur_NAME`, and `ur list` describes it by its line `##Summary: ...`.
`ur new multi` writes such programs.
"""


def plan_package(name: str, summary: str, maintainer: str, email: str) -> tuple[NewFile, ...]:
    """Plan an empty package, ready for `ur new node`."""
    text = _PACKAGE.format(
        name=name, summary=escape_text(summary), maintainer=escape_text(maintainer), email=escape_text(email)
    )
    return (
        NewFile("package.xml", text),
        NewFile("CMakeLists.txt", CMAKE.format(name=name)),
        NewFile("bin/README.md", _BIN.format(name=name)),
    )


_BASE = """\
summary: {summary}
# Lengths in m, masses in kg, angles in rad, times in s; say here where the figures come from.
footprint: [[{front}, {side}], [-{front}, {side}], [-{front}, -{side}], [{front}, -{side}]]
height: {height:g}
ground_clearance: {clearance:g}
mass: {mass:g}
wheels: {{radius: {radius:g}, width: {wheel:g}, separation: {separation:g}, mass: {wheel_mass:g}}}
casters:
  - {{x: {caster:g}, y: 0.0, radius: {ball:g}}}
  - {{x: -{caster:g}, y: 0.0, radius: {ball:g}}}
limits:
  {{velocity: {velocity:g}, angular_velocity: {angular_velocity:g}, acceleration: 0.8, angular_acceleration: 2.5,
   deceleration: 3.0, angular_deceleration: 8.0, command_age: 0.08{aside}}}
odometry: {{rate: 20, ticks_per_turn: 1000, wheel_noise: 0.003, radius_error: 0.003, separation_error: 0.006}}
"""
_LIDAR = """\
  lidar:
    frame: laser
    topic: scan
    pose: [0.0, 0.0, {height:g}, 0.0, 0.0, 0.0]
    angle_min: -3.14159265
    angle_max: 3.12413936 # 360 beams, 1 degree apart
    samples: 360
    rate: 8
    range_min: 0.12
    range_max: 12.0
    noise: 0.015
"""
_CAMERA = """\
  raspicam: # straight ahead; field of view: Raspberry Pi camera v2, 62.2 degrees
    frame: raspicam
    pose: [{front:g}, 0.0, {height:g}, 0.0, 0.0, 0.0]
    width: 640
    height: 480
    field_of_view: 1.0856
    rate: 15
"""


def write_base(request: BaseRequest) -> str:
    """Return the text of a base.yaml: a rectangle on two driven wheels and two casters."""
    front, side = request.length / 2.0, request.width / 2.0
    text = _BASE.format(
        summary=json.dumps(" ".join(request.summary.split()), ensure_ascii=False),  # YAML reads it as JSON does
        front=f"{front:g}",
        side=f"{side:g}",
        height=request.height,
        clearance=min(0.03, request.wheel_radius / 2.0),
        mass=request.mass,
        radius=request.wheel_radius,
        wheel=min(0.03, request.wheel_radius),
        separation=request.wheel_separation,
        wheel_mass=round(request.mass / 20.0, 3),
        caster=round(front * 0.75, 3),
        ball=min(0.02, request.wheel_radius / 2.0),
        velocity=request.velocity,
        angular_velocity=request.angular_velocity,
        aside=f",\n   lateral_velocity: {request.lateral_velocity:g}" if request.lateral_velocity else "",
    )
    sensors = ""
    if request.lidar:
        sensors += _LIDAR.format(height=round(request.height + 0.05, 3))
    if request.raspicam:
        sensors += _CAMERA.format(front=front + 0.005, height=round(request.height * 0.8, 3))
    return text + (f"sensors:\n{sensors}" if sensors else "")
