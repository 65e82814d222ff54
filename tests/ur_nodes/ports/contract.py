"""What every backend of `ur_nodes.ports` promises: checks that are given two nodes and a way to let time pass."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from tests.ur_nodes.ports import goal_checks, raw_checks
from tests.ur_nodes.ports.samples import CALIBRATION, GRID, POSES, VALUES, fields_of
from tests.ur_nodes.ports.stage import STAMP, Stage

from ur.source.diagnostic import UserError
from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.ports import values
from ur_nodes.ports.node import Sender
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, AskPath, Place, Silent, Switch, Trigger, UseCalibration, UseMap
from ur_nodes.ports.values import Map, Result, Transform, Twist


def check_value_of_each_kind_arrives_as_it_was_sent(stage: Stage) -> None:
    got: dict[int, object] = {}
    publishers = []
    sent = list(VALUES)
    for index, value in enumerate(sent):
        kind: type[Any] = type(value)
        stage.other.subscribe(f"values/v{index}", kind, partial(got.__setitem__, index), Quality.LATCHED)
        publishers.append(stage.one.publish(f"values/v{index}", kind, Quality.LATCHED))
    stage.begin()
    for publisher, value in zip(publishers, sent, strict=True):
        publisher.send(value)
    stage.until(lambda: len(got) == len(sent))
    for index, value in enumerate(sent):
        assert type(got[index]) is type(value)
        assert fields_of(got[index]) == fields_of(value)


def check_each_counts_in_order_where_every_one_counts(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("every", int, Quality.EVERY)
    stage.other.subscribe("every", int, got.append, Quality.EVERY)
    stage.begin()
    stage.until(lambda: publisher.listeners() == 1)
    for number in range(50):
        publisher.send(number)
    stage.until(lambda: len(got) == 50)
    assert got == list(range(50))


def check_none_is_lost_where_sending_waits(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("lossless", int, Quality.LOSSLESS)
    stage.other.subscribe("lossless", int, got.append, Quality.LOSSLESS)
    stage.begin()
    stage.until(lambda: publisher.listeners() == 1)
    for number in range(500):
        publisher.send(number)
    stage.until(lambda: len(got) == 500)
    assert got == list(range(500))


def check_newest_replaces_those_that_wait(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("newest", int)
    stage.other.subscribe("newest", int, got.append)
    stage.begin()
    stage.until(lambda: publisher.listeners() == 1)
    for number in range(1000):  # no callback comes between them
        publisher.send(number)
    stage.until(lambda: 999 in got)
    assert got == sorted(got)
    assert len(got) < 1000


def check_value_that_cannot_be_read_is_told_to_who_asks(stage: Stage) -> None:
    got: list[object] = []
    reasons: list[str] = []
    stage.other.subscribe("spoilt", Map, got.append, unreadable=reasons.append)
    stage.begin()
    stage.spoil("spoilt")
    stage.until(lambda: bool(reasons))
    assert reasons == ["map with resolution 0, expected more than 0 m"]
    assert not got


def check_latched_topic_gives_its_last_value_to_who_comes_later(stage: Stage) -> None:
    got: list[tuple[str, Sender | None]] = []
    publisher = stage.one.publish("kept", str, Quality.LATCHED)
    publisher.send("old")
    publisher.send("new")
    stage.other.subscribe_from("kept", str, lambda value, sender: got.append((value, sender)), Quality.LATCHED)
    stage.begin()
    stage.until(lambda: bool(got))
    assert [value for value, _ in got] == ["new"]
    sender = got[0][1]
    assert sender is not None
    assert sender.name == stage.one.name


def check_publishers_of_a_topic_are_told_apart_and_what_they_send_has_its_moment(stage: Stage) -> None:
    senders: dict[int, list[Sender]] = {1: [], 2: []}
    first, second = (stage.one.publish("moments", int, Quality.COMMAND) for _ in senders)

    def take(value: int, sender: Sender | None) -> None:
        assert sender is not None
        senders[value].append(sender)

    stage.other.subscribe_from("moments", int, take, Quality.EVERY)
    stage.begin()
    stage.one.every(0.02, lambda: first.send(1))
    stage.one.every(0.02, lambda: second.send(2))
    stage.until(lambda: min(len(got) for got in senders.values()) > 3)
    ids = [{each.id for each in got} for got in senders.values()]
    if not stage.moments_known:
        assert ids == [{""}, {""}]
        return
    assert len(ids[0] | ids[1]) == 2
    for got in senders.values():
        moments = [(each.sent or 0, each.arrived or 0.0) for each in got]
        assert moments == sorted(moments)
        assert 0.0 < moments[0][1] <= stage.other.steady()


def check_latched_topic_keeps_values_where_both_ends_are_latched(stage: Stage) -> None:
    late: list[str] = []
    each: list[str] = []
    unmatched: list[str] = []
    kept = stage.one.publish("kept_once", str, Quality.LATCHED)
    plain = stage.one.publish("not_kept", str, Quality.EVERY)
    kept.send("old")
    stage.other.subscribe("kept_once", str, late.append, Quality.EVERY)
    stage.other.subscribe("not_kept", str, each.append, Quality.EVERY)
    stage.other.subscribe("not_kept", str, unmatched.append, Quality.LATCHED)
    stage.begin()
    stage.until(lambda: min(kept.listeners(), plain.listeners()) > 0)
    stage.one.every(0.05, lambda: kept.send("new"))
    stage.one.every(0.05, lambda: plain.send("new"))
    stage.until(lambda: "new" in late and len(each) > 2)
    if not stage.keeps_for_all:
        assert set(late) == {"new"}
        assert not unmatched


def check_latched_value_comes_first_where_each_counts(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("kept_and_each", int, Quality.LATCHED)
    publisher.send(0)
    stage.other.subscribe("kept_and_each", int, got.append, Quality.LATCHED_EVERY)
    stage.begin()
    stage.until(lambda: len(got) == 1)
    for number in range(1, 4):
        publisher.send(number)
        stage.until(lambda count=number + 1: len(got) == count)  # type: ignore[misc]
    assert got == [0, 1, 2, 3]


def check_who_begins_to_listen_is_greeted(stage: Stage) -> None:
    got: list[float] = []
    stage.one.publish("greeted", float, greet=lambda: 0.5)
    stage.other.subscribe("greeted", float, got.append)
    stage.begin()
    stage.until(lambda: bool(got))
    assert set(got) == {0.5}


def check_closed_subscription_hears_nothing(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("closed", int, Quality.EVERY)
    heard: list[int] = []
    closed = stage.other.subscribe("closed", int, heard.append, Quality.EVERY)
    stage.begin()
    stage.until(lambda: publisher.listeners() == 1)
    closed.close()
    stage.until(lambda: publisher.listeners() == 0)
    stage.other.subscribe("closed", int, got.append, Quality.EVERY)
    stage.until(lambda: publisher.listeners() == 1)
    publisher.send(3)
    stage.until(lambda: got == [3])
    assert heard == []


def check_service_answers_with_result_and_text(stage: Stage) -> None:
    got: list[Result] = []
    stage.other.serve("light", Switch, lambda request: Result(request.on, "on" if request.on else "there is no light"))
    stage.begin()
    stage.one.call("light", Switch(on=True), got.append)
    stage.until(lambda: len(got) == 1)
    stage.one.call("light", Switch(on=False), got.append)
    stage.until(lambda: len(got) == 2)
    assert got == [Result(True, "on"), Result(False, "there is no light")]


def check_each_request_arrives_as_it_was_made(stage: Stage) -> None:
    placed = values.PlacedPose(STAMP, "map", Pose2(1.0, 2.0, 0.5))
    path = values.Path(STAMP, "map", POSES)
    map_of = values.Map(STAMP, "map", GRID)
    asked: tuple[tuple[object, object], ...] = (
        (Trigger(), None),
        (Silent(), None),
        (AskMap(), map_of),
        (UseMap(map_of, STAMP, "map", Pose2(0.5, 0.25, 0.125), np.arange(9.0).reshape(3, 3)), None),
        (Place("box", "map", Pose2(1.0, 2.0, 0.5)), None),
        (AskPath(placed, placed, 0.25), path),
        (UseCalibration(CALIBRATION), None),
    )
    requests: list[object] = []
    results: list[Result] = []

    def answer(value: object, request: object) -> Result:
        requests.append(request)
        return Result(success=True, value=value)

    for request, value in asked:
        kind: type[Any] = type(request)
        stage.other.serve(f"ask_{kind.__name__}", kind, partial(answer, value))
    stage.begin()
    for number, (request, value) in enumerate(asked, 1):
        stage.one.call(f"ask_{type(request).__name__}", request, results.append)
        stage.until(lambda count=number: len(results) == count)  # type: ignore[misc]  # mypy infers no default
        assert results[-1].success, results[-1].text
        assert fields_of(requests[-1]) == fields_of(request)
        assert fields_of(results[-1].value) == fields_of(value)


def check_failure_of_a_silent_service_reaches_its_client(stage: Stage) -> None:
    got: list[Result] = []
    stage.other.serve("scatter", Silent, lambda _request: Result(False, "there is no map"))
    stage.begin()
    stage.one.call("scatter", Silent(), got.append)
    stage.until(lambda: bool(got))
    if stage.silent_services_hide_failures:
        assert got[0].success
    else:
        assert not got[0].success
        assert "there is no map" in got[0].text


def check_missing_service_is_a_result(stage: Stage) -> None:
    got: list[Result] = []
    stage.begin()
    stage.one.call("nobody/serves_this", Trigger(), got.append, 0.3)
    stage.until(lambda: bool(got))
    assert not got[0].success
    assert "nobody/serves_this" in got[0].text


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
    assert {own.name("word"), own.name("deep/er")} <= set(own.names())
    assert own.of("").any(own.name("word").lstrip("/")) == "fast"
    with pytest.raises(UserError, match="expected a number"):
        own.number("word")
    with pytest.raises(UserError, match="is not set"):
        own.text("absent")


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
    for name, check in [*globals().items(), *vars(goal_checks).items(), *vars(raw_checks).items()]
    if name.startswith("check_")
}
