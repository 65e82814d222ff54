"""The first script of a user, written by `ur new script`."""

from ur.tools.new.parts import NewFile

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
