"""A state machine: search for free floor, go there, come home; each state is a function that returns the next one."""

from collections.abc import Callable

from ur_nodes.client import Refused, Robot

State = Callable[[Robot], "State | None"]


def search(robot: Robot) -> "State | None":
    """Turn to the left until a metre is free ahead."""
    if robot.nearest(width=40) > 1.0:
        return advance
    robot.drive(0.0, 0.6, seconds=0.5)
    return search


def advance(robot: Robot) -> "State | None":
    """Drive ahead for two seconds."""
    robot.drive(0.2, 0.0, seconds=2.0)
    return come_home


def come_home(robot: Robot) -> "State | None":
    """Return to where the program began."""
    try:
        robot.go_to(*home)
    except Refused as reason:
        print(f"not home: {reason}")
    return None


with Robot() as robot:
    start = robot.pose()
    home = (start.x, start.y)
    state: State | None = search
    while state is not None:
        print(state.__name__)
        state = state(robot)
