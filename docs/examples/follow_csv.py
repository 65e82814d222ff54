"""Drive to the places of places.csv, in order; go on with the next where there is no way to one."""

import csv

from ur_nodes.client import Refused, Robot

with Robot() as robot, open("places.csv", newline="") as file:
    for x, y in csv.reader(file):
        try:
            robot.go_to(float(x), float(y))
        except Refused as reason:
            print(f"{x} {y}: {reason}")
        else:
            print(f"{x} {y}: reached")
