"""Robot's ends without a process: what pages send and show is kept."""

import asyncio
from collections.abc import Callable, Collection, Mapping
from typing import Any

from ur.web.server.robot_process import RobotProcess


class KeptRobotEnd(RobotProcess):
    """A robot's end that keeps what is sent. `on_look`, where it is set, is called in place of the process."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.passed: list[Any] = []
        self.on_look: Callable[..., None] | None = None

    def send(self, message: Mapping[str, object]) -> None:
        self.passed.append(message)

    def look(self, viewers: int, layers: Collection[int], plots: Collection[str] = (), camera: str = "") -> None:
        if self.on_look is None:
            super().look(viewers, layers, plots, camera)
        else:
            self.on_look(viewers, layers, plots, camera)


class IdleRobotEnd(KeptRobotEnd):
    """One that is up from the beginning, and keeps what stops the robot."""

    def send(self, message: Mapping[str, object]) -> None:
        if "do" in message:
            super().send(message)

    async def run(self) -> None:
        self.state = "up"
        await asyncio.Event().wait()


def keep(ends: list[Any], kind: type[KeptRobotEnd] = KeptRobotEnd) -> Callable[..., RobotProcess]:
    """A maker of robot's ends, for an Application, that puts what it makes into a list."""

    def make(*given: Any) -> RobotProcess:
        ends.append(kind(*given))
        made: RobotProcess = ends[-1]
        return made

    return make
