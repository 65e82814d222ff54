"""What every backend of `ur_nodes.ports` promises: checks that are given two nodes and a way to let time pass."""

import threading
from collections.abc import Callable
from functools import partial

import pytest
from tests.ur_nodes.ports import goal_checks, raw_checks, service_checks, topic_checks
from tests.ur_nodes.ports.stage import STAMP, Stage

from ur.source.diagnostic import UserError
from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result, Transform, Twist


def check_callbacks_of_a_node_share_one_thread(stage: Stage) -> None:
    threads: set[int] = set()
    done: list[object] = []

    def note(value: object) -> None:
        threads.add(threading.get_ident())
        done.append(value)

    def answer(_request: Trigger) -> Result:
        note("service")
        return Result(success=True)

    publisher = stage.one.publish("threads", str, Quality.LATCHED)
    stage.one.subscribe("threads", str, note)
    stage.one.serve("threads", Trigger, answer)
    stage.begin()
    timer = stage.one.every(0.01, lambda: note("beat") if "beat" not in done else None)
    stage.one.work(lambda: "job", note)
    stage.one.call("threads", Trigger(), lambda _result: note("result"))
    publisher.send("value")
    stage.until(lambda: {"service", "beat", "job", "result", "value"} <= set(done))
    timer.cancel()
    assert len(threads) == 1


def check_other_threads_post_calls_to_the_thread_of_the_node(stage: Stage) -> None:
    threads: list[int] = []
    calls: list[int] = []
    stage.one.after(0.0, lambda: threads.append(threading.get_ident()))
    stage.begin()

    def post() -> None:
        for number in range(50):
            stage.one.post(partial(calls.append, number))
        stage.one.post(lambda: threads.append(threading.get_ident()))

    other = threading.Thread(target=post)
    other.start()
    other.join()
    stage.until(lambda: len(calls) == 50 and len(threads) == 2)
    assert calls == list(range(50))
    assert len(set(threads)) == 1


def check_beats_repeat_until_they_are_cancelled(stage: Stage) -> None:
    beats: list[int] = []
    others: list[int] = []
    timer = stage.one.every(0.01, lambda: beats.append(stage.one.now()))
    stage.begin()
    stage.until(lambda: len(beats) >= 5)
    timer.cancel()
    stage.one.every(0.01, lambda: others.append(0))
    stage.until(lambda: len(others) >= 2)
    count = len(beats)
    stage.until(lambda: len(others) >= 6)
    assert len(beats) <= count + 1
    assert beats == sorted(beats)


def check_later_call_comes_once_unless_it_is_cancelled(stage: Stage) -> None:
    calls: list[str] = []
    stage.one.after(0.01, lambda: calls.append("once"))
    stage.one.after(0.01, lambda: calls.append("steady"), steady=True)
    stage.one.after(0.01, lambda: calls.append("cancelled")).cancel()
    stage.begin()
    stage.one.after(0.05, lambda: calls.append("last"))
    stage.until(lambda: "last" in calls)
    assert calls == ["once", "steady", "last"]


def check_answer_may_come_later(stage: Stage) -> None:
    got: list[Result] = []
    stage.other.serve_later(
        "slow", Trigger, lambda _request, give: stage.other.work(lambda: Result(True, "done"), give, "writes")
    )
    stage.other.serve_later("never", Trigger, lambda _request, _give: None)
    stage.begin()
    given_up: list[Result] = []
    stage.one.call("never", Trigger(), given_up.append, 0.3)
    stage.one.call("slow", Trigger(), got.append)
    stage.until(lambda: bool(got and given_up))
    assert got == [Result(True, "done")]
    assert not given_up[0].success
    assert "never" in given_up[0].text


def check_jobs_of_the_end_are_done(stage: Stage) -> None:
    if stage.one is stage.other:
        return  # the test's own process would end with it
    done: list[str] = []
    node = stage.one
    node.on_end(lambda: node.work(lambda: "drawn", lambda word: node.work(lambda: f"{word}, written", done.append)))
    stage.begin()
    node.end("the test is over")
    stage.until(lambda: done == ["drawn, written"])


def check_calls_without_delay_let_others_in(stage: Stage) -> None:
    got: list[Result] = []

    def again() -> None:
        if not got:
            stage.one.after(0.0, again, steady=True)

    stage.other.serve("between", Trigger, lambda _request: Result(True, "done"))
    stage.one.after(0.0, again, steady=True)
    stage.begin()
    stage.one.call("between", Trigger(), got.append)
    stage.until(lambda: bool(got))
    assert got == [Result(True, "done")]


def check_parameters_are_typed_and_kept(stage: Stage) -> None:
    own = stage.one.parameters
    assert own.number("speed", 0.5) == 0.5
    own.keep("speed", 0.75)
    own.keep("deep/er", 3)
    assert own.number("speed", 0.5) == 0.75
    assert own.below("deep").integer("er") == 3
    assert own.has("deep")
    assert own.any("deep") == {"er": 3}
    own.keep("word", "fast")
    assert own.of("").any(own.name("word").lstrip("/")) == "fast"
    with pytest.raises(UserError, match="expected a number"):
        own.number("word")
    with pytest.raises(UserError, match="is not set"):
        own.text("absent")


def check_live_parameters_are_applied_and_others_refused(stage: Stage) -> None:
    applied: list[tuple[float, int, bool]] = []

    def read(own: Parameters) -> tuple[float, int, bool]:
        limits = own.below("limits")
        return (
            limits.limit("speed", 0.5, minimum=0.1, live="greatest speed, m/s"),
            limits.integer("count", 3, minimum=1, live="a number of things"),
            own.boolean("careful", False, live="drive with care"),
        )

    own = stage.one.parameters
    assert own.follow(read, applied.append) == (0.5, 3, False)
    assert own.text("frame", "map") == "map"
    stage.begin()
    assert stage.set_parameter("limits/speed", 0.25) == ""
    assert stage.set_parameter("careful", True) == ""
    assert stage.set_parameter("limits/count", 2) == ""
    assert applied == [(0.25, 3, False), (0.25, 3, True), (0.25, 2, True)]
    assert "expected a number from 0.1 to 0.5" in stage.set_parameter("limits/speed", 0.6)
    assert "expected a whole number of at least 1" in stage.set_parameter("limits/count", 0)
    if not stage.only_live_parameters:
        assert "read at the start only; set it in the launch file" in stage.set_parameter("frame", "odom")
    assert stage.set_parameter("limits/other", 1.0)
    assert len(applied) == 3
    speed = stage.describe("limits/speed")
    assert speed.text.startswith("greatest speed, m/s")
    assert (speed.minimum, speed.maximum, speed.read_only) == (0.1, 0.5, False)
    assert stage.describe("limits/count").minimum == 1
    if not stage.only_live_parameters:
        assert stage.describe("frame").read_only


def check_facts_are_known_to_all_nodes(stage: Stage) -> None:
    assert stage.one.facts.get("contract_fact", 1) == 1
    stage.one.facts.set("contract_fact", "known")
    assert stage.other.facts.get("contract_fact") == "known"


def check_first_transform_reaches_nodes_that_listen(stage: Stage) -> None:
    tree = stage.other.transforms
    stage.begin()
    moved = Pose3(1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    stage.one.post(lambda: stage.one.transforms.send(Transform(STAMP, "first_map", "first_odom", moved)))
    stage.until(lambda: tree.find("first_map", "first_odom") is not None)


def check_transforms_reach_other_nodes(stage: Stage) -> None:
    tree = stage.other.transforms
    mount = Pose3(0.25, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0)
    moved = Pose3(1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    stage.one.transforms.send(Transform(STAMP, "base", "laser", mount, fixed=True))
    stage.one.transforms.send(Transform(STAMP, "base", "imu", mount, fixed=True))
    stage.begin()
    stamp = iter(range(STAMP, STAMP + 10**12, 10**7))
    stage.one.every(0.02, lambda: stage.one.transforms.send(Transform(next(stamp), "odom", "base", moved)))
    stage.until(lambda: None not in (tree.find("odom", "laser"), tree.find("odom", "imu")))
    found = tree.find("odom", "laser")
    assert found == moved.compose(mount)


def check_what_is_sent_at_the_end_still_leaves(stage: Stage) -> None:
    if stage.one is stage.other:
        return  # the listener would end with it
    got: list[Twist] = []
    publisher = stage.one.publish("last", Twist, Quality.COMMAND)
    stage.other.subscribe("last", Twist, got.append)
    stage.one.on_end(lambda: publisher.send(Twist(0.0, 0.0)))
    stage.begin()
    stage.one.end("the test is over")
    stage.until(lambda: got == [Twist(0.0, 0.0)])


def check_messages_without_a_kind_must_be_known(stage: Stage) -> None:
    with pytest.raises(LookupError):
        stage.one.subscribe_fields("foreign", "no_such_package/Sensor", ("name",), print)


def check_nodes_are_located(stage: Stage) -> None:
    place = stage.one.locate(stage.other.name)
    assert place is not None
    assert place.here
    assert stage.one.locate("/no/such/node") is None


def check_names_are_resolved(stage: Stage) -> None:
    assert stage.one.resolve("scan") == "/scan"
    assert stage.one.resolve("/tf") == "/tf"
    assert stage.one.resolve("~goal") == f"{stage.one.name}/goal"


CHECKS: dict[str, Callable[[Stage], None]] = {
    name.removeprefix("check_"): check
    for name, check in [
        *vars(topic_checks).items(),
        *vars(service_checks).items(),
        *globals().items(),
        *vars(goal_checks).items(),
        *vars(raw_checks).items(),
    ]
    if name.startswith("check_")
}
