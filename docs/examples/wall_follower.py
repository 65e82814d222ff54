"""Keep half a metre from what is on the left, for four seconds."""

from ur_nodes.client import Robot

DISTANCE, SPEED = 0.5, 0.15

with Robot() as robot:
    for _ in range(10):
        if robot.nearest(width=60) < 0.45:
            robot.drive(0.0, -0.6, seconds=0.4)  # something is ahead: turn away from the wall
            continue
        error = min(robot.nearest(width=60, direction=60), 1.0) - DISTANCE
        robot.drive(SPEED, max(-0.5, min(0.5, error)), seconds=0.4)
    print(f"the wall is {robot.nearest(width=120, direction=90):.2f} m away")
