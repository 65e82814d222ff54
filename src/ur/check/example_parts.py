"""Shared parts of the rules' examples: a few launch files, to which each rule adds lines."""

from ur.check.rule import Example, launch_example

TALKER = '<node name="talker" pkg="demo_nodes" type="talker"/>'
SUMMARY = "<!--Summary: Say something.-->"
OVERVIEW = "<!--Overview: Once per second.-->"
MARKED_LAUNCH = "«<launch»>"
PROGRAM_HEAD = """#!/bin/bash
##Summary: Say something.
##Overview: Once per second.
"""
_SPEED = '<arg name="speed" default="0.5"/>'


def make_launch(*lines: str, tag: str = "<launch>") -> str:
    """Return a launch file that begins with `tag` and contains these lines."""
    return "\n".join((tag, *(f"  {line}" for line in lines), "</launch>", ""))


def make_speed_launch(declared: str = _SPEED, value: str = "$(arg speed)") -> str:
    """Return a launch file that declares the argument `speed` in the line `declared`, and uses `value`."""
    return make_launch(declared, f'<param name="speed" value="{value}"/>')


def make_talk_launch(*lines: str, says: str | None = None, tag: str = "<launch>") -> str:
    """Return a launch file that follows the conventions; `says` are arguments of its node `talker`."""
    talker = TALKER if says is None else TALKER.replace("/>", f' args="{says}"/>')
    return make_launch(SUMMARY, OVERVIEW, *lines, talker, tag=tag)


def speed_example(declared: str = _SPEED, value: str = "$(arg speed)") -> Example:
    """Return an example with one launch file, `make_speed_launch`."""
    return launch_example(make_speed_launch(declared, value))


def passing_example(passed: str = '<arg name="speed" value="0.3"/>', declared: str = _SPEED) -> Example:
    """Return an example that includes `make_speed_launch(declared)`, with the line `passed` in its `<include>`."""
    include = ('<include file="$(find my_robot)/launch/part.launch.xml">', f"  {passed}", "</include>")
    return launch_example(make_launch(*include), {"launch/part.launch.xml": make_speed_launch(declared)})


def group_example(tag: str) -> Example:
    """Return an example with a talker in a group that begins with `tag`."""
    return launch_example(make_launch(tag, f"  {TALKER}", "</group>"))


def directory_example(text: str, file: str = "n_talker.launch") -> Example:
    """Return an example of a launch file in the directory `n_talker` of a package that follows the conventions."""
    return launch_example(text, name=f"n_talker/launch/{file}")
