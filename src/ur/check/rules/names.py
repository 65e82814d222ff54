"""Rules about the names of nodes, namespaces, remappings and machines."""

from ur.check.example_parts import group_example, make_launch
from ur.check.rule import Rule, RuleGroup, launch_examples
from ur.source.diagnostic import Severity

RULES = (
    Rule(
        id="bad-clear-params",
        group=RuleGroup.NAMES,
        severity=Severity.ERROR,
        summary="clear_params stands without the name of what is cleared.",
        explanation="""
`clear_params` deletes the parameters of a namespace, so `<group>` and `<include>` need `ns` beside it.
""",
        bad=(group_example('<group «clear_params»="true">'),),
        good=(group_example('<group clear_params="true" ns="left">'),),
    ),
    Rule(
        id="bad-name",
        group=RuleGroup.NAMES,
        severity=Severity.ERROR,
        summary="A name is not one that ROS can use.",
        explanation="""
Names begin with a letter and go on with letters, digits and `_`. The name of a node holds no `/`; its namespace
goes into `ns`.
""",
        bad=launch_examples(make_launch('<node name="«left/talker»" pkg="demo_nodes" type="talker"/>')),
        good=launch_examples(make_launch('<node name="talker_1" pkg="demo_nodes" type="talker" ns="left"/>')),
    ),
    Rule(
        id="bad-remap",
        group=RuleGroup.NAMES,
        severity=Severity.ERROR,
        summary="A remapping is not made of two ROS names.",
        explanation="""
`from` and `to` are names of topics or services: letters, digits, `_` and `/`.
""",
        bad=launch_examples(
            make_launch(
                '<node name="talker" pkg="demo_nodes" type="talker">',
                '  <remap from="chatter" to="«my chatter»"/>',
                "</node>",
            )
        ),
        good=launch_examples(
            make_launch(
                '<node name="talker" pkg="demo_nodes" type="talker">',
                '  <remap from="chatter" to="/left/chatter"/>',
                "</node>",
            )
        ),
    ),
    Rule(
        id="duplicate-machine",
        group=RuleGroup.MACHINES,
        severity=Severity.ERROR,
        summary="Two machines have the same name and differ.",
        explanation="""
A machine may be defined again with equal attributes, for instance by two included files, and not with others.
""",
        bad=launch_examples(
            make_launch('<machine name="robot" address="robot.local"/>', '<machine name="«robot»" address="10.0.0.2"/>')
        ),
        good=launch_examples(
            make_launch('<machine name="robot" address="robot.local"/>', '<machine name="other" address="10.0.0.2"/>')
        ),
    ),
    Rule(
        id="duplicate-node",
        group=RuleGroup.NAMES,
        severity=Severity.ERROR,
        summary="Two nodes have the same name.",
        explanation="""
A name belongs to one node at a time: the ROS master ends the first when the second starts, so roslaunch refuses
the file.
""",
        bad=launch_examples(
            make_launch(
                '<node name="talker" pkg="demo_nodes" type="talker"/>',
                '<node name="«talker»" pkg="demo_nodes" type="listener"/>',
            )
        ),
        good=launch_examples(
            make_launch(
                '<node name="talker" pkg="demo_nodes" type="talker"/>',
                '<node name="talker" pkg="demo_nodes" type="talker" ns="left"/>',
            )
        ),
    ),
    Rule(
        id="empty-namespace",
        group=RuleGroup.NAMES,
        severity=Severity.ERROR,
        summary="An ns attribute is empty.",
        explanation="""
roslaunch refuses `ns=''`. Leave the attribute away, or write `/` for the root.
""",
        bad=(group_example('<group «ns»="">'),),
        good=(group_example('<group ns="left">'),),
    ),
    Rule(
        id="obsolete-machine",
        group=RuleGroup.MACHINES,
        severity=Severity.ERROR,
        summary="A machine is described as before ROS Fuerte.",
        explanation="""
`ros-root`, `ros-package-path`, `ros-ip`, `ros-hostname` and `<env>` inside `<machine>` were removed: `env-loader`
names a script that sets the environment.
""",
        bad=launch_examples(make_launch('<machine name="robot" address="robot.local" «ros-root»="/opt/ros"/>')),
        good=launch_examples(make_launch('<machine name="robot" address="robot.local" env-loader="/opt/ros/env.sh"/>')),
    ),
    Rule(
        id="unknown-machine",
        group=RuleGroup.MACHINES,
        severity=Severity.ERROR,
        summary="A node names a machine that is not defined.",
        explanation="""
`machine` names a `<machine>` of the same run; `localhost` has to be defined, too. A file that others include is judged
where they include it, and a file that includes one that cannot be found here is left alone.
""",
        bad=launch_examples(
            make_launch(
                '<machine name="robot" address="robot.local"/>',
                '<node name="talker" pkg="demo_nodes" type="talker" machine="«robto»"/>',
            )
        ),
        good=launch_examples(
            make_launch(
                '<machine name="robot" address="robot.local"/>',
                '<node name="talker" pkg="demo_nodes" type="talker" machine="robot"/>',
            )
        ),
    ),
)
