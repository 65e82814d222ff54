"""An assistant's server beside a simulated robot on a bus: the SDK's client calls it while simulated time passes."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Callable, Mapping
from pathlib import Path
from typing import Any

from mcp.client import Client
from tests.ur_nodes.first_drive.drive import FirstDrive

from ur.mcp.assistant import Assistant
from ur.mcp.grants import Area, GrantFiles, make_grant
from ur.mcp.robot_link import LinkError, Values
from ur.mcp.serve import make_server
from ur.system.child_processes import PendingAnswers
from ur_nodes.assistant.session import AssistantSession

STEP = 0.01  # s of simulated time between two looks of the server at its sockets


class BusLink:
    """See RobotLink: the robot's end on a bus. `silent`: signs of life do not arrive any more."""

    def __init__(self, stage: FirstDrive) -> None:
        self._answers = PendingAnswers[Values](LinkError)
        self.session = AssistantSession(stage.bus.node("assistant"), self)
        self.silent = False
        self.beats = 0
        self.challenge = 0
        self.on_revoked: Callable[[str], None] = lambda _: None

    async def ask(self, message: Values, limit: float) -> Values:  # noqa: ARG002 - real time is another here
        number, answer = self._answers.add()
        self.send({**message, "id": number})
        try:
            return await asyncio.wait_for(answer, 100.0)  # less than a test has
        except asyncio.TimeoutError:
            raise LinkError("the robot does not answer") from None

    def send(self, message: Values) -> None:
        self.beats += message["do"] == "beat"
        if not self.silent:
            self.session.handle(json.loads(json.dumps(message)))

    async def close(self) -> None:
        """End nothing: the robot's end is the test's."""

    def send_line(self, value: Mapping[str, object]) -> None:
        if "revoked" in value:
            self.on_revoked(str(value["revoked"]))
        elif "challenge" in value:
            self.challenge = int(str(value["challenge"]))
        else:
            self._answers.give(value.get("id"), json.loads(json.dumps(value)))


class AssistedRobot:
    """A robot, the server of an assistant, and what the robot did: `samples` are (s, m/s, rad/s, x, y).

    What is sent on the topics `lost` gets lost.
    """

    def __init__(self, folder: Path) -> None:
        self.lost: set[str] = set()
        self.stage = FirstDrive(delay=lambda topic: None if topic in self.lost else 0)
        vars(self.stage.bus.nodes["/cmd_vel_mux"])["facts"].simulated_time = False  # ages count, as on a robot
        self.link = BusLink(self.stage)
        self.files = GrantFiles(folder / "mcp")
        self.assistant = Assistant(self.link, self.files, 1, self._sleep)
        self.samples: list[tuple[float, float, float, float, float]] = []
        self.assistant.begin()
        self.stage.bus.run(1.0)

    def grant(self, speed: float = 0.2, minutes: float = 30.0, within: tuple[Area, ...] = (), **more: Any) -> None:
        """Grant as a person does in a terminal."""
        self.files.give(self.assistant.id, make_grant(minutes, speed, within, more.pop("avoid", ()), **more))

    def connect(self) -> contextlib.AbstractAsyncContextManager[Client]:
        """A client, while time passes."""
        return self.connect_as("auto")

    @contextlib.asynccontextmanager
    async def connect_as(self, version: str, *, remote: bool = False) -> AsyncIterator[Client]:
        """A client of a version of the protocol, behind ssh if it is `remote`, while time passes."""
        running = [asyncio.create_task(self._run()), asyncio.create_task(self.assistant.watch())]
        try:
            async with Client(make_server(self.assistant, remote=remote), mode=version) as client:
                yield client
        finally:
            for each in running:
                each.cancel()
            await asyncio.gather(*running, return_exceptions=True)

    def step(self, seconds: float = STEP) -> None:
        """Let time pass."""
        self.stage.bus.run(seconds)
        truth = self.stage.truth
        self.samples.append((self.now, abs(truth.twist.forward), abs(truth.twist.turn), truth.pose.x, truth.pose.y))

    @property
    def now(self) -> float:
        """Simulated time, s."""
        return self.stage.bus.now * 1e-9

    async def _sleep(self, seconds: float) -> None:
        """Wait for simulated time."""
        until = self.now + seconds
        while self.now < until:
            await asyncio.sleep(0)

    async def _run(self) -> None:
        while True:
            self.step()
            await asyncio.sleep(0)


def text_of(result: Any) -> str:
    """The text of the result of a tool."""
    return "".join(each.text for each in result.content)
