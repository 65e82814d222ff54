"""Drive half a metre ahead, turn around once, and print the way that is free in each direction."""

from ur_nodes.client import Robot

with Robot() as robot:
    here = robot.pose()
    robot.go_to(here.x + 0.5, here.y)
    for direction in (0, 90, 180, 270):
        print(f"{direction} degrees: {robot.nearest(width=20, direction=direction):.2f} m")
