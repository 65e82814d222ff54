"""Programs with asyncio: their tasks are cancelled while the robot drives."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.ur_nodes.first_drive.drive import FirstDrive

from ur_nodes.client import AsyncRobot, Refused


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FirstDrive:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    return FirstDrive()


def connect(stage: FirstDrive) -> AsyncRobot:
    return AsyncRobot("script", node=stage.bus.node("script"), wait=stage.bus.run_until)


async def test_calls_have_the_values_of_the_robot(stage: FirstDrive) -> None:
    async with connect(stage) as robot:
        here, scan, picture = await robot.pose(), await robot.scan(), await robot.map()
        assert len(scan.ranges) > 100
        assert picture.grid.resolution > 0.0
        assert await robot.nearest() > 0.0
        assert await robot.events() == ()
        (there,) = await robot.follow([(here.x + 0.3, here.y)])
        await robot.stop()
        assert abs(there.x - here.x - 0.3) < 0.2
        assert (await robot.battery()).voltage > 0.0


async def test_task_that_is_cancelled_stops_the_robot(stage: FirstDrive) -> None:
    loop = asyncio.get_running_loop()
    tasks: list[asyncio.Task[None]] = []

    def wait(condition: Callable[[], bool], seconds: float) -> bool:
        def look() -> bool:
            if tasks and abs(stage.truth.twist.turn) > 0.2:
                loop.call_soon_threadsafe(tasks.pop().cancel)
            return condition()

        return stage.bus.run_until(look, seconds)

    async with AsyncRobot("script", node=stage.bus.node("script"), wait=wait) as robot:
        tasks.append(task := asyncio.create_task(robot.drive(0.0, 0.5, 60.0)))
        with pytest.raises(asyncio.CancelledError):
            await task
        assert stage.bus.now < 62e9
    stage.bus.run(0.3)
    assert abs(stage.truth.twist.turn) < 0.02


async def test_refusal_of_the_robot_is_that_of_the_call(stage: FirstDrive) -> None:
    async with connect(stage) as robot:
        with pytest.raises(Refused):
            await robot.go_to(1000.0, 1000.0)
        with pytest.raises(Refused, match="nothing explores"):
            await robot.explore()
