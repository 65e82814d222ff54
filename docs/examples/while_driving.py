"""Drive to a place, and do something else meanwhile: with asyncio, a task that is cancelled stops the robot."""

import asyncio

from ur_nodes.client import AsyncRobot


async def main() -> None:
    """Go half a metre ahead, but at most for a second; then stop."""
    async with AsyncRobot() as robot:
        here = await robot.pose()
        drive = asyncio.create_task(robot.go_to(here.x + 0.5, here.y))
        try:
            await asyncio.wait_for(drive, timeout=1.0)
            print("reached")
        except asyncio.TimeoutError:
            print("not there after a second: stopped")
        there = await robot.pose()
        print(f"{abs(there.x - here.x):.2f} m from the start")


asyncio.run(main())
