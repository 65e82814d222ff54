"""Turn in steps until the gap between two near things is ahead, as a dock with two posts has it."""

from ur_nodes.client import Robot

with Robot() as robot:
    for step in range(16):
        left, ahead, right = (robot.nearest(width=30, direction=each) for each in (40, 0, -40))
        if ahead > left and ahead > right:
            print(f"a gap is ahead after {step} steps: {left:.2f} m, {ahead:.2f} m, {right:.2f} m")
            break
        robot.drive(0.0, 0.4, seconds=1.0)
    else:
        print("no gap was found")
