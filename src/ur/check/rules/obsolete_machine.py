"""A machine is described as before ROS Fuerte."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="obsolete-machine",
    group=Group.MACHINES,
    severity=Severity.ERROR,
    summary="A machine is described as before ROS Fuerte.",
    explanation="""
`ros-root`, `ros-package-path`, `ros-ip`, `ros-hostname` and `<env>` inside `<machine>` are gone: `env-loader`
names a script that sets the environment.
""",
    bad=(
        launch_example("""
<launch>
  <machine name="robot" address="robot.local" «ros-root»="/opt/ros"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <machine name="robot" address="robot.local" env-loader="/opt/ros/env.sh"/>
</launch>
"""),
    ),
)
