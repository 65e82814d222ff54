"""Drive to a place with a time limit: another thread stops the drive."""

import threading

from ur_nodes.client import Interrupted, Robot

with Robot() as robot:
    here = robot.pose()
    timer = threading.Timer(1.0, robot.interrupt)
    timer.start()
    try:
        robot.go_to(here.x + 0.5, here.y)
        print("reached")
    except Interrupted:
        print("not there after a second: stopped")
    timer.cancel()
    there = robot.pose()
    print(f"{abs(there.x - here.x):.2f} m from the start")
