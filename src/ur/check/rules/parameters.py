"""Rules about `<param>` and `<rosparam>`."""

import re
from collections.abc import Iterable

from ur.check.example_parts import make_launch
from ur.check.rule import PlanView, Rule, RuleFinding, RuleGroup, launch_examples
from ur.source.diagnostic import Note, Severity

# What may publish /clock, by its program and arguments, as `rosbag play --clock` does
_CLOCKS = re.compile(
    r"clock|gazebo|stage|sim(?!ple)|morse|webots|coppelia|vrep|unity|carla|flatland|player(?!s)|/rosbag ", re.IGNORECASE
)
_DRIVERS = re.compile(
    r"rplidar|urg_node|hokuyo|sick_|lms1xx|ydlidar|ldlidar|velodyne_driver|usb_cam|raspicam_node|realsense2?_camera|"
    r"openni2?_launch|astra_camera|rosserial|serial_node|ubiquity_motor|kobuki_node|create_driver|nmea_navsat|ublox_gps"
)
_DRIVES = ("drives real hardware", "set /use_sim_time to false, or leave it out")
_PLAYS = ("plays a file without --clock", "add --clock to its args, unless the file has a /clock of its own")


def _find_no_clock(view: PlanView) -> Iterable[RuleFinding]:
    param = next((each for each in view.plan.params if each.name == "/use_sim_time" and each.value is True), None)
    element = view.element_at(param.origin.span.file.path, param.origin.span.start) if param else None
    programs = [(node, f"{node.package}/{node.type} {node.args}") for node in view.plan.nodes]
    if (
        param is None
        or element is None
        or not all(include.found for include in view.plan.includes)
        or any(_CLOCKS.search(program) for _, program in programs)
    ):
        return
    for node, program in programs:
        if not (plays := program.startswith("rosbag/play ")) and not _DRIVERS.search(program):
            continue
        reason, help_ = _PLAYS if plays else _DRIVES
        place = element.value_span("value") if "value" in element.attributes else element.span
        message = f"simulated time, and no node publishes /clock: all nodes wait for it, and {node.full_name} {reason}"
        yield RuleFinding(place, message, help_, (Note(f"{node.full_name} is here", node.origin.span),), param.name)
        return


RULES = (
    Rule(
        id="bad-param-type",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="The type of a parameter is not known.",
        explanation="""
Known are `str`, `int`, `double`, `bool` and `yaml`; without `type` roslaunch guesses.
""",
        bad=launch_examples(make_launch('<param name="speed" type="«float»" value="0.3"/>')),
        good=launch_examples(make_launch('<param name="speed" type="double" value="0.3"/>')),
    ),
    Rule(
        id="bad-param-value",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A parameter's value is not of its type.",
        explanation="""
roslaunch converts the text to the type that `type=` names, and refuses the file when it cannot.
""",
        bad=launch_examples(make_launch('<param name="count" type="int" value="«3.5»"/>')),
        good=launch_examples(make_launch('<param name="count" type="int" value="3"/>')),
    ),
    Rule(
        id="bad-yaml-key",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A key in YAML is not a text.",
        explanation="""
Names of parameters are texts. YAML reads `1`, `yes` and `on` as something else, unless they stand in quotes.
""",
        bad=launch_examples(make_launch("<rosparam>", "  speeds: {«1»: 0.3}", "</rosparam>")),
        good=launch_examples(make_launch("<rosparam>", "  speeds: {first: 0.3}", "</rosparam>")),
    ),
    Rule(
        id="no-clock",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="Nodes wait for a simulated time that no node publishes.",
        explanation="""
With `/use_sim_time` every node waits for `/clock`, which a simulator or `rosbag play --clock` publishes. Reported are
files that start a driver or play a file without `--clock`, and nothing that may be a simulator. `ur launch` reports
after 5 s that nodes wait.
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
        bad=launch_examples(
            make_launch('<param name="wheel" value="round"/>', '«<param» name="wheel/radius" value="0.1"/>')
        ),
        good=launch_examples(
            make_launch('<param name="wheel/shape" value="round"/>', '<param name="wheel/radius" value="0.1"/>')
        ),
    ),
    Rule(
        id="param-value",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A parameter has no value, or more than one.",
        explanation="""
`<param>` takes exactly one of `value`, `textfile`, `binfile` and `command`.
""",
        bad=launch_examples(make_launch('«<param» name="speed" />')),
        good=launch_examples(make_launch('<param name="speed" value="0.3"/>')),
    ),
    Rule(
        id="rosparam-file",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A rosparam deletes with a file.",
        explanation="""
`command='delete'` removes parameters by name; a file belongs to `load` and `dump`.
""",
        bad=launch_examples(make_launch('<rosparam command="delete" param="speed" «file»="speed.yaml"/>')),
        good=launch_examples(make_launch('<rosparam command="delete" param="speed"/>')),
    ),
    Rule(
        id="rosparam-not-a-mapping",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A rosparam holds a value and does not say which parameter it is.",
        explanation="""
Without `param`, a `<rosparam>` holds names with values.
""",
        bad=launch_examples(make_launch("«<rosparam»>[1, 2, 3]</rosparam>")),
        good=launch_examples(make_launch('<rosparam param="wheels">[1, 2, 3]</rosparam>')),
    ),
    Rule(
        id="too-many-params",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="More than 500,000 parameters are set.",
        explanation="""
The parameter server is not made for data of this size: load it in the node, from a file. The limit keeps `ur` from
hanging.
""",
        bad=(),
        good=(),
    ),
)
