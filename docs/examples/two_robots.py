"""Let robots drive half a metre ahead, one after the other: 'ur run two_robots.py bob eve'.

A program has one robot, so this one starts itself once for each. All are connected before the first one drives.
"""

import os
import subprocess
import sys
from typing import TextIO

from ur_nodes.client import Robot


def drive(turn: TextIO) -> None:
    """Drive one robot when a line says that it is its turn, and print where it is then."""
    with Robot() as robot:
        here = robot.pose()
        print("ready", flush=True)
        if turn.readline():
            there = robot.go_to(here.x + 0.5, here.y)
            print(f"is at {there.x:.2f} {there.y:.2f} m", flush=True)


def start(robot: str) -> "subprocess.Popen[str]":
    """Start the program of one robot."""
    pipe, environment = subprocess.PIPE, {**os.environ, "UR_ROBOT": robot}
    return subprocess.Popen(["ur", "run", __file__], env=environment, stdin=pipe, stdout=pipe, text=True)


def main(robots: list[str]) -> None:
    """Start the programs of all robots, then let each have its turn."""
    programs = {robot: start(robot) for robot in robots}
    for robot, program in programs.items():
        if program.stdout and program.stdout.readline() != "ready\n":
            sys.exit(f"{robot} does not answer")
    for robot, program in programs.items():
        text, _ = program.communicate("go\n")
        print(f"{robot} {text.strip() or 'did not get there'}")


if __name__ == "__main__":
    main(sys.argv[1:]) if sys.argv[1:] else drive(sys.stdin)
