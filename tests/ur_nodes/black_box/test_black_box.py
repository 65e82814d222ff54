"""The black box on a bus: what it takes, when it writes, and what it writes."""

import socket
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import pytest
from mcap.reader import make_reader

from ur.recordings.black_boxes import notify_black_boxes
from ur.recordings.mcap_file import open_recording
from ur_nodes.black_box.black_box import BlackBox, BlackBoxSettings, Triggers
from ur_nodes.black_box.black_box_node import EventSocket, read_settings, share_memory
from ur_nodes.black_box.history import MessageHistory, Ring, read_history
from ur_nodes.black_box.recording_file import list_recordings, write_recording
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.lease.text import Lease, write_lease
from ur_nodes.ports.actions import Goal, GoalHandle, GoalState
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result, StampedPose

STRING = "std_msgs/String"


class World:
    """A black box, and a robot that publishes a text ten times a second."""

    def __init__(self, folder: Path, size: int = 1_000_000) -> None:
        self.folder = folder
        self.unix = 10**18  # ns since 1970 where the bus has 0
        self.bus = Bus()
        self.bus.schemas[STRING] = "string data\n"
        self.robot = self.bus.node("robot")
        self.words = self.robot.raw.publish("words", STRING)
        self.count = 0
        self.robot.every(0.1, self._speak)
        self.node = self.bus.node("black_box")
        self.ring = Ring(memoryview(bytearray(size)))
        self.box = BlackBox(self.node, BlackBoxSettings(), self.ring, self.write, lambda: self.bus.now)

    def write(self, reasons: Sequence[str]) -> str:
        """Write a file as the process that the black box starts for that does."""
        return str(write_recording(self.folder, tuple(read_history(self.ring)), reasons, self.unix, 3))

    def _speak(self) -> None:
        self.count += 1
        self.words.send(b"%d" % self.count)

    def recordings(self) -> list[tuple[list[str], list[tuple[float, int]]]]:
        """The reasons of each recording, and the times and numbers of its words."""
        found = []
        for path in list_recordings(self.folder):
            with path.open("rb") as file:
                reader = make_reader(file)
                words = [
                    ((message.log_time - 10**18) / 1e9, int(message.data))
                    for _, channel, message in reader.iter_messages()
                    if channel.topic == "/words"
                ]
                (reasons,) = [each.metadata for each in reader.iter_metadata() if each.name == "reasons"]
            found.append((list(reasons.values()), words))
        return found


def test_nothing_is_written_between_events(tmp_path: Path) -> None:
    World(tmp_path).bus.run(300.0)
    assert list(tmp_path.iterdir()) == []


def test_recording_has_two_minutes_before_an_event_and_the_seconds_after_it(tmp_path: Path) -> None:
    world = World(tmp_path)
    world.bus.run(200.0)
    answers: list[Result] = []
    world.robot.call("black_box/write", Trigger(), answers.append, 30.0)
    world.bus.run(10.0)
    ((reasons, words),) = world.recordings()
    assert reasons == ["requested"]
    (path,) = list_recordings(tmp_path)
    assert answers == [Result(True, f"{socket.gethostname()}:{path}")]
    assert words[-1][0] - words[0][0] == pytest.approx(120.0, abs=0.2)
    numbers = [number for _, number in words]
    assert numbers == list(range(numbers[0], numbers[-1] + 1))


def test_clock_that_jumps_moves_the_whole_recording(tmp_path: Path) -> None:
    world = World(tmp_path)
    world.bus.run(20.0)
    world.unix += 3600 * 10**9
    world.robot.call("black_box/write", Trigger(), lambda _result: None)
    world.bus.run(10.0)
    ((_, words),) = world.recordings()
    assert {round(after[0] - before[0], 6) for before, after in pairwise(words)} == {0.1}


def test_topic_of_100_mb_per_second_is_kept_once_a_second_beside_complete_others(tmp_path: Path) -> None:
    world = World(tmp_path, 20_000_000)
    flood = world.robot.raw.publish("flood", STRING)
    block = bytes(1_000_000)
    world.robot.every(0.01, lambda: flood.send(block))
    world.bus.run(20.0)
    world.robot.call("black_box/write", Trigger(), lambda _result: None)
    world.bus.run(10.0)
    ((_, words),) = world.recordings()
    numbers = [number for _, number in words]
    assert numbers == list(range(numbers[0], numbers[-1] + 1))
    (path,) = list_recordings(tmp_path)
    recording = open_recording(path)
    times = [each.time for each in recording.messages(topics={"/flood"})]
    assert times
    assert all(after - before >= 10**9 for before, after in pairwise(times))


def press(world: World) -> None:
    world.robot.publish("cmd_vel_mux/stopped", bool, Quality.LATCHED).send(True)


def touch(world: World) -> None:
    bumper = world.robot.publish("bumper/left", bool, Quality.LATCHED)
    world.bus.run(7.0)
    bumper.send(True)


def lose(world: World) -> None:
    lost = world.robot.publish("amcl/lost", str, Quality.LATCHED)
    lost.send("")
    lost.send("the scan fits nowhere")
    lost.send("the scan fits nowhere")


class Refusing:
    """Navigation that refuses each goal."""

    def handle_goal(self, handle: GoalHandle) -> None:
        handle.refuse("no path")

    def handle_cancel(self, handle: GoalHandle) -> None:
        """Nothing."""


class Ignoring:
    """A client that does not care what becomes of its goals."""

    def on_states(self, states: tuple[GoalState, ...]) -> None:
        """Nothing."""

    def on_goal_end(self, state: GoalState) -> None:
        """Nothing."""


def abort(world: World) -> None:
    world.robot.serve_goals("move_base", Refusing())
    client = world.bus.node("client").follow_goals("move_base", Ignoring())
    world.bus.run(1.0)
    client.send(Goal("goal", StampedPose(0, "map", Pose2(1.0, 2.0, 0.0))))


def take_over(world: World) -> None:
    lease = world.robot.publish("cmd_vel_mux/lease", str, Quality.LATCHED)
    for each in (Lease(), Lease("held", "a" * 8), Lease("lost", "a" * 8), Lease("held", "b" * 8), Lease()):
        lease.send(write_lease(each))
        world.bus.run(0.1)


@pytest.mark.parametrize(
    ("happen", "reason"),
    [
        (press, "the emergency stop was pressed"),
        (touch, "bumper left was touched"),
        (lose, "localisation is lost: the scan fits nowhere"),
        (abort, "a goal was aborted: no path"),
        (take_over, "another client has taken over"),
    ],
)
def test_event_of_the_robot_is_written_once(tmp_path: Path, happen: Callable[[World], None], reason: str) -> None:
    world = World(tmp_path)
    world.bus.run(6.0)
    happen(world)
    world.bus.run(20.0)
    assert [reasons for reasons, _ in world.recordings()] == [[reason]]


def test_what_was_in_force_before_is_no_event() -> None:
    bus = Bus()
    robot = bus.node("robot")
    stopped = robot.publish("cmd_vel_mux/stopped", bool, Quality.LATCHED)
    lost = robot.publish("amcl/lost", str, Quality.LATCHED)
    stopped.send(True)
    lost.send("the scan fits nowhere")
    happened: list[str] = []
    triggers = Triggers(happened.append, lambda: bus.now)
    triggers.subscribe(bus.node("black_box"), "cmd_vel_mux", "move_base", "amcl")
    bus.run(8.0)
    assert happened == []
    stopped.send(False)
    bus.run(1.0)
    stopped.send(True)
    bus.run(1.0)
    assert happened == ["the emergency stop was pressed"]


def test_events_that_follow_each_other_are_one_recording(tmp_path: Path) -> None:
    world = World(tmp_path)
    world.bus.run(6.0)
    press(world)
    world.bus.run(1.0)
    lose(world)
    world.bus.run(20.0)
    assert [len(reasons) for reasons, _ in world.recordings()] == [2]


def test_event_just_before_the_end_is_written_at_the_end(tmp_path: Path) -> None:
    world = World(tmp_path)
    world.bus.run(6.0)
    press(world)
    world.bus.run(0.1)
    world.node.end("the run ends")
    world.bus.run(1.0)
    assert [reasons for reasons, _ in world.recordings()] == [["the emergency stop was pressed"]]


def test_folder_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    world = World(tmp_path / "file/folder")
    world.bus.run(6.0)
    answers: list[Result] = []
    press(world)
    world.robot.call("black_box/write", Trigger(), answers.append, 30.0)
    world.bus.run(10.0)
    assert [each.success for each in answers] == [False]
    assert "not a directory" in answers[0].text
    assert any("not a directory" in line for line in (text for _, text in world.node.lines))


@pytest.mark.parametrize("below", ["", "a folder with a long name/" * 5], ids=["short", "longer than an address"])
def test_other_processes_report_events(tmp_path: Path, below: str) -> None:
    environment = {"XDG_STATE_HOME": str(tmp_path / below)}
    assert notify_black_boxes(environment, "/camera died: exit code 1") == 0
    bus = Bus()
    got: list[str] = []
    events = EventSocket(bus.node("black_box"), environment, got.append)
    assert notify_black_boxes(environment, "/camera died: exit code 1") == 1
    bus.run(0.2)
    assert got == ["/camera died: exit code 1"]
    assert notify_black_boxes(environment, "") == 1
    events.close()
    assert got[1:] == ["unnamed event"]
    assert notify_black_boxes(environment, "again") == 0


def test_black_box_runs_without_a_folder_for_its_socket(tmp_path: Path) -> None:
    (tmp_path / "ur").write_text("")
    node = Bus().node("black_box")
    EventSocket(node, {"XDG_STATE_HOME": str(tmp_path)}, lambda _: None).close()
    assert "the end of other nodes is not noticed" in node.lines[0][1]


def test_parameters_of_the_node_are_used(tmp_path: Path) -> None:
    bus = Bus()
    node = bus.node("black_box")
    values = {"seconds": 60.0, "after": 2.0, "cameras": False, "mux": "mux", "folder": str(tmp_path), "kept": 1}
    for name, value in {**values, "megabytes": 1.0}.items():
        bus.parameters[f"/black_box/{name}"] = value
    assert read_settings(node.parameters) == BlackBoxSettings(60.0, 2.0, "mux", cameras=False)
    memory = share_memory(node.parameters)
    MessageHistory(Ring(memoryview(memory.block))).note_event(1, "one")
    assert len(memory.block) == 1_000_000
    assert {Path(memory.write(["one"])).parent for _ in range(2)} == {tmp_path}
    assert len(list_recordings(tmp_path)) == 1
    memory.end()
