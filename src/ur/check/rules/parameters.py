"""Rules about `<param>` and `<rosparam>`."""

from __future__ import annotations

import re
from collections.abc import Iterable

from ur.check.example_parts import make_launch
from ur.check.rule import PlanView, Rule, RuleFinding, RuleGroup, launch_examples
from ur.launchfile.plan.specs import NodeSpec
from ur.source.diagnostic import Note, Severity

_SIMULATORS = re.compile(
    r"gazebo|stage|sim(?!ple)|morse|webots|coppelia|vrep|unity|carla|flatland|player(?!s)|clock|/rosbag ", re.IGNORECASE
)
_DRIVERS = re.compile(
    r"rplidar|urg_node|hokuyo|sick_|lms1xx|ydlidar|ldlidar|velodyne_driver|usb_cam|raspicam_node|realsense2?_camera|"
    r"openni2?_launch|astra_camera|rosserial|serial_node|ubiquity_motor|kobuki_node|create_driver|nmea_navsat|ublox_gps"
)


def _find_no_clock(view: PlanView) -> Iterable[RuleFinding]:
    param = next((each for each in view.plan.params if each.name == "/use_sim_time" and each.value is True), None)
    element = view.element_at(param.origin.span.file.path, param.origin.span.start) if param else None
    if element is None or not all(include.found for include in view.plan.includes):
        return
    waiting: list[tuple[NodeSpec, str, str]] = []
    for node in view.plan.nodes:
        program = f"{node.package}/{node.type} {node.args}"
        if (node.package, node.type) == ("rosbag", "play"):
            if "--clock" in node.args:
                return
            waiting.append((node, "plays a file without --clock", "add --clock to its args"))
        elif _SIMULATORS.search(program):
            return
        elif _DRIVERS.search(program):
            waiting.append((node, "drives real hardware", "set /use_sim_time to false, or leave it out"))
    for node, reason, help_ in waiting[:1]:
        place = element.value_span("value") if "value" in element.attributes else element.span
        message = f"simulated time, and no node publishes /clock: all nodes wait for it, and {node.full_name} {reason}"
        yield RuleFinding(
            place, message, help_, (Note(f"{node.full_name} is here", node.origin.span),), "/use_sim_time"
        )


RULES = (
    Rule(
        id="bad-param-type",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="The type of a parameter is not known.",
        explanation="""
Known are `str`, `int`, `double`, `bool` and `yaml`; without `type` roslaunch guesses.
""",
        bad=launch_examples("""
<launch>
  <param name="speed" type="«float»" value="0.3"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <param name="speed" type="double" value="0.3"/>
</launch>
"""),
    ),
    Rule(
        id="bad-param-value",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A parameter's value is not of its type.",
        explanation="""
roslaunch converts the text to the type that `type=` names, and refuses the file when it cannot.
""",
        bad=launch_examples("""
<launch>
  <param name="count" type="int" value="«3.5»"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <param name="count" type="int" value="3"/>
</launch>
"""),
    ),
    Rule(
        id="bad-yaml-key",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A key in YAML is not a text.",
        explanation="""
Names of parameters are texts. YAML reads `1`, `yes` and `on` as something else, unless they stand in quotes.
""",
        bad=launch_examples("""
<launch>
  <rosparam>
    speeds: {«1»: 0.3}
  </rosparam>
</launch>
"""),
        good=launch_examples("""
<launch>
  <rosparam>
    speeds: {first: 0.3}
  </rosparam>
</launch>
"""),
    ),
    Rule(
        id="no-clock",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="Nodes wait for a simulated time that no node publishes.",
        explanation="""
With `/use_sim_time` every node waits for `/clock`, which a simulator or `rosbag play --clock` publishes. Reported are
files that start a driver of real hardware, or play a file without `--clock`, and nothing that may be a simulator; what
you start elsewhere is not known here. `ur launch` reports after 5 s that nodes wait.
""",
        bad=launch_examples(
            make_launch(
                '<param name="/use_sim_time" value="«true»"/>',
                '<node name="lidar" pkg="rplidar_ros" type="rplidarNode"/>',
            ),
            make_launch(
                '<param name="/use_sim_time" value="«true»"/>',
                '<node name="play" pkg="rosbag" type="play" args="drive.bag"/>',
            ),
        ),
        good=launch_examples(
            make_launch(
                '<param name="/use_sim_time" value="true"/>',
                '<node name="play" pkg="rosbag" type="play" args="--clock drive.bag"/>',
            )
        ),
        plan=_find_no_clock,
    ),
    Rule(
        id="param-conflict",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="A parameter lies inside another one that is a value.",
        explanation="""
A parameter is either a value or a namespace. roslaunch sets both, and the later one replaces the earlier.
""",
        bad=launch_examples("""
<launch>
  <param name="wheel" value="round"/>
  «<param» name="wheel/radius" value="0.1"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <param name="wheel/shape" value="round"/>
  <param name="wheel/radius" value="0.1"/>
</launch>
"""),
    ),
    Rule(
        id="param-value",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A parameter has no value, or more than one.",
        explanation="""
`<param>` takes exactly one of `value`, `textfile`, `binfile` and `command`.
""",
        bad=launch_examples("""
<launch>
  «<param» name="speed" />
</launch>
"""),
        good=launch_examples("""
<launch>
  <param name="speed" value="0.3"/>
</launch>
"""),
    ),
    Rule(
        id="rosparam-file",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A rosparam deletes with a file.",
        explanation="""
`command='delete'` removes parameters by name; a file belongs to `load` and `dump`.
""",
        bad=launch_examples("""
<launch>
  <rosparam command="delete" param="speed" «file»="speed.yaml"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <rosparam command="delete" param="speed"/>
</launch>
"""),
    ),
    Rule(
        id="rosparam-not-a-mapping",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A rosparam holds a value and does not say which parameter it is.",
        explanation="""
Without `param`, a `<rosparam>` holds names with values.
""",
        bad=launch_examples("""
<launch>
  «<rosparam»>[1, 2, 3]</rosparam>
</launch>
"""),
        good=launch_examples("""
<launch>
  <rosparam param="wheels">[1, 2, 3]</rosparam>
</launch>
"""),
    ),
    Rule(
        id="too-many-params",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="More than 500,000 parameters are set.",
        explanation="""
The parameter server is not made for data of this size: load it in the node, from a file. The limit is part of
what keeps `ur` from hanging, so there is no example here.
""",
        bad=(),
        good=(),
    ),
)
