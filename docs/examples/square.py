"""Drive a square by velocities alone, without a map, and say how far from its start it ends."""

import math

from ur_nodes.client import Robot

SIDE, SPEED, TURN = 0.3, 0.15, 0.5

with Robot() as robot:
    start = robot.pose()
    for _ in range(4):
        robot.drive(SPEED, 0.0, seconds=SIDE / SPEED)
        robot.drive(0.0, TURN, seconds=math.pi / 2 / TURN)
    end = robot.pose()
    print(f"{math.hypot(end.x - start.x, end.y - start.y):.2f} m from the start")
