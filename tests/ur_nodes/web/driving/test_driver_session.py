"""Pages that drive a robot with a mux, on a bus: who may, what is too late, and that the robot stops."""

import math

import pytest
from tests.ur_nodes.teleop.recordings import PLACE, serve_recordings
from tests.ur_nodes.web.robot_world import DrivingPage, RobotWorld

from ur_nodes.motion.lease.text import read_lease
from ur_nodes.navigation.goals.goal_claim import read_claim
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Twist
from ur_nodes.web.driving.page_lease import GAP

pytestmark = pytest.mark.usefixtures("home")

STILL = Twist(0.0, 0.0)
STOP_TIME = 0.3  # s, of which the lag of the wheels is part


@pytest.fixture
def world() -> RobotWorld:
    return RobotWorld()


def lease_of(world: RobotWorld) -> tuple[str, str]:
    found = world.state()["lease"]
    return found["state"], found["client"]


def test_stick_drives_and_the_robot_stops_when_it_is_let_go(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.wanted = (1, 0.3, 0.0)
    assert max(world.forward(1.5)) == pytest.approx(0.3)
    page.wanted = None
    page.ask("let_go", hold=1)
    released = world.bus.now
    assert world.forward(1.0)[-1] == 0.0
    at_rest = next(at for at, twist in world.speeds if twist == STILL)
    assert at_rest - released <= STOP_TIME * 1e9
    assert lease_of(world) == ("held", "web-a")


def test_stick_whose_commands_stay_away_stops_the_robot_and_counts_no_more(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.wanted = (1, 0.3, 0.0)
    world.bus.run(1.0)
    page.wanted = None
    last = world.bus.now
    assert world.forward(1.0)[-1] == 0.0
    assert next(at for at, twist in world.speeds if twist == STILL) - last <= STOP_TIME * 1e9
    assert {"t": "over", "hold": 1, "why": "late"} in page.told()
    page.wanted = (1, 0.3, 0.0)
    assert not any(world.forward(1.0)), "a press that is over stays over"
    page.wanted = (2, 0.3, 0.0)
    assert max(world.forward(1.0)) > 0.0


def test_stick_that_answers_an_old_challenge_does_not_drive(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.ask("stick", late=True, hold=1, forward=0.3, turn=0.0)
    assert not any(world.forward(0.5))
    assert page.told() == [{"t": "over", "hold": 1, "why": "late"}]


def test_challenges_that_stay_away_end_a_press() -> None:
    lost: set[str] = set()
    world = RobotWorld(lambda topic: None if topic in lost else 0)
    page = DrivingPage(world)
    page.wanted = (1, 0.3, 0.0)
    world.bus.run(1.0)
    lost.add("/cmd_vel_mux/challenge")
    assert {"t": "over", "hold": 1, "why": "late"} in page.told(GAP + 0.2)
    assert world.forward(1.0)[-1:] in ([], [0.0])


def test_without_a_mux_no_press_drives() -> None:
    world = RobotWorld()
    world.mux.end("ended")
    page = DrivingPage(world)
    page.ask("stick", hold=1, forward=0.3, turn=0.0)
    assert page.told(0.0) == [{"t": "over", "hold": 1, "why": "no mux"}]


def test_speeds_beyond_those_of_the_base_are_bounded(world: RobotWorld) -> None:
    sent: list[Twist] = []
    world.robot.subscribe("web_vel_stamped", StampedTwist, lambda value: sent.append(value.twist))
    page = DrivingPage(world)
    page.ask("stick", hold=1, forward=99.0, turn=-99.0, left=99.0)
    world.bus.run(0.1)
    limits = world.state()["robot"]["limits"]
    assert sent[0] == Twist(limits[0], -limits[1], limits[2])


def test_page_of_another_browser_cannot_drive_until_it_takes_the_lease(world: RobotWorld) -> None:
    first, second = DrivingPage(world), DrivingPage(world, "web-b", "other")
    first.wanted = (1, 0.2, 0.0)
    world.bus.run(1.0)
    second.ask("stick", hold=1, forward=-0.2, turn=0.0)
    assert second.told(0.2) == [{"t": "over", "hold": 1, "why": "driver"}]
    assert min(world.forward(0.5)) > 0.0
    first.wanted = None
    second.ask("lease", do="take")
    world.bus.run(1.0)
    assert lease_of(world) == ("held", "web-b")
    first.ask("stick", hold=2, forward=0.2, turn=0.0)
    assert {"t": "over", "hold": 2, "why": "driver"} in first.told()


def test_page_that_leaves_stops_the_robot_at_once_and_keeps_the_lease_until_it_is_lost(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.wanted = (1, 0.3, 0.0)
    world.bus.run(1.0)
    page.leave()
    left = world.bus.now
    assert world.forward(1.0)[-1] == 0.0
    assert next(at for at, twist in world.speeds if twist == STILL) - left <= STOP_TIME * 1e9
    assert lease_of(world) == ("held", "web-a")
    world.bus.run(5.0)
    assert lease_of(world)[0] == "lost"
    again = DrivingPage(world, "web-b", "browser")
    again.wanted = (1, 0.3, 0.0)
    assert max(world.forward(1.0)) > 0.0, "a page of the same browser may go on"


def test_page_that_cannot_come_again_leaves_no_goal_and_no_lease(world: RobotWorld) -> None:
    page = DrivingPage(world, once=True)
    page.ask("goal", x=1.0, y=2.0, yaw=0.5)
    world.bus.run(1.0)
    assert lease_of(world) == ("held", "web-a")
    page.leave()
    world.bus.run(0.5)
    assert len(world.navigation.cancelled) == 1
    assert lease_of(world)[0] == "free"


def test_end_of_the_node_stops_what_pages_hold(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.wanted = (1, 0.3, 0.0)
    world.bus.run(1.0)
    page.wanted, page.alive = None, False
    ended = world.bus.now
    world.node.end("the server has ended")
    assert world.forward(1.0)[-1] == 0.0
    assert next(at for at, twist in world.speeds if twist == STILL) - ended <= STOP_TIME * 1e9


def test_goal_acquires_the_lease_and_claims_it_and_the_lease_goes_back_after_its_end(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.ask("goal", x=1.0, y=2.0, yaw=0.5)
    assert page.told() == [{"t": "sent", "what": "goal", "number": 1}]
    handle = world.navigation.goals[0]
    assert tuple(handle.goal.target.pose) == (1.0, 2.0, 0.5)
    claim = read_claim(handle.goal.id)
    assert claim is not None
    assert claim.client == "web-a"
    assert lease_of(world) == ("held", "web-a")
    handle.succeed("reached")
    world.bus.run(5.0)
    assert lease_of(world)[0] == "free"


def test_goal_without_a_heading_says_so(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.ask("goal", x=1.0, y=2.0, yaw=None)
    world.bus.run(1.0)
    assert world.state()["goal"]["place"] == [1.0, 2.0, None]
    assert math.isfinite(world.navigation.goals[0].goal.target.pose.yaw)


@pytest.mark.parametrize(("request_", "what"), [("goal", "goal"), ("pose", "pose")], ids=["goal", "pose"])
def test_requests_that_set_something_in_motion_are_refused_when_they_are_late(
    world: RobotWorld, request_: str, what: str
) -> None:
    page = DrivingPage(world)
    page.ask(request_, late=True, x=1.0, y=2.0, yaw=0.5)
    assert page.told() == [{"t": "refused", "what": what, "why": "late"}]
    assert world.navigation.goals == []


def test_goal_of_a_page_that_may_not_drive_is_refused(world: RobotWorld) -> None:
    DrivingPage(world).ask("lease", do="acquire")
    world.bus.run(1.0)
    other = DrivingPage(world, "web-b", "other")
    other.ask("goal", x=1.0, y=2.0, yaw=0.5)
    assert other.told() == [{"t": "refused", "what": "goal", "why": "driver"}]
    other.ask("go_to", place="nowhere")
    assert other.told() == [{"t": "refused", "what": "go_to", "why": "no place"}]
    assert world.navigation.goals == []


def test_release_of_the_lease_cancels_the_goal_of_its_page(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.ask("goal", x=1.0, y=2.0, yaw=0.5)
    world.bus.run(1.0)
    page.ask("lease", do="release")
    world.bus.run(1.0)
    assert len(world.navigation.cancelled) == 1
    assert lease_of(world)[0] == "free"


def test_any_page_stops_the_robot_and_limits_its_speed(world: RobotWorld) -> None:
    driver, other = DrivingPage(world), DrivingPage(world, "web-b", "other")
    driver.wanted = (1, 0.3, 0.0)
    world.bus.run(1.0)
    other.ask("stop")
    assert world.forward(1.0)[-1] == 0.0
    assert world.state()["mux"]["stopped"] is True
    driver.wanted = None
    other.ask("release")
    other.ask("limit", percent=40)
    world.bus.run(1.0)
    state = world.state()
    assert (state["mux"]["stopped"], state["limit"]) == (False, 40)
    world.end.on_drive({"do": "stop", "page": "a viewer"})
    world.bus.run(0.5)
    assert world.state()["mux"]["stopped"] is True


def test_what_is_no_request_is_answered_and_an_unknown_page_is_not(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.ask("fly")
    page.ask("stick", hold=-1, forward=0.0, turn=0.0)
    assert [each["t"] for each in page.told()] == ["bad", "bad"]
    world.pages["web-x"] = page
    world.end.on_drive({"page": "web-x", "m": '{"t": "stop"}'})
    assert page.told() == []
    assert world.state()["mux"]["stopped"] is False


def test_pages_are_bounded_and_names_are_printable(world: RobotWorld) -> None:
    pages = [DrivingPage(world, f"web-{number}") for number in range(101)]
    world.end.on_drive({"do": "name", "page": "web-100", "name": "a\x1b[2Jb"})
    pages[-1].ask("lease", do="acquire")
    world.bus.run(1.0)
    lease = world.state()["lease"]
    assert lease["client"] == "web-100"
    assert "\x1b" not in lease["name"]
    pages[0].ask("lease", do="take")
    world.bus.run(1.0)
    assert lease_of(world) == ("held", "web-100"), "the page that came first had to go"


def test_lease_that_is_no_text_of_a_mux_changes_nothing(world: RobotWorld) -> None:
    before = lease_of(world)
    world.bus.node("rogue").publish("cmd_vel_mux/lease", str, Quality.LATCHED).send("{")
    assert read_lease("{") is None
    assert lease_of(world) == before


def test_what_happened_is_saved_by_the_black_box_where_there_is_one(world: RobotWorld) -> None:
    page = DrivingPage(world)
    page.ask("save_recording")
    refused = {"t": "refused", "why": "no service /black_box/write within 30 s", "what": "save_recording"}
    assert page.told(31.0) == [refused]
    serve_recordings(world.bus)
    page.ask("save_recording")
    assert page.told() == [{"t": "done", "place": PLACE, "what": "save_recording"}]
