"""Topics, as every backend of `ur_nodes.ports` promises them."""

from functools import partial
from typing import Any

from tests.ur_nodes.ports.samples import VALUES, fields_of
from tests.ur_nodes.ports.stage import Stage

from ur_nodes.ports.node import Sender
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map


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
    stage.until(lambda: publisher.subscribers() == 1)
    for number in range(50):
        publisher.send(number)
    stage.until(lambda: len(got) == 50)
    assert got == list(range(50))


def check_none_is_lost_where_sending_waits(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("lossless", int, Quality.LOSSLESS)
    stage.other.subscribe("lossless", int, got.append, Quality.LOSSLESS)
    stage.begin()
    stage.until(lambda: publisher.subscribers() == 1)
    for number in range(500):
        publisher.send(number)
    stage.until(lambda: len(got) == 500)
    assert got == list(range(500))


def check_newest_replaces_those_that_wait(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("newest", int)
    stage.other.subscribe("newest", int, got.append)
    stage.begin()
    stage.until(lambda: publisher.subscribers() == 1)
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
    assert reasons == ["map with resolution 0, expected 0.0001 to 1000 m"]
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


def check_latched_topic_gives_its_last_value_to_a_second_subscription_of_a_node(stage: Stage) -> None:
    sent = next(each for each in VALUES if isinstance(each, Map))
    first: list[Map] = []
    second: list[Map] = []
    publisher = stage.one.publish("kept_for_two", Map, Quality.LATCHED)
    publisher.send(sent)
    stage.other.subscribe("kept_for_two", Map, first.append, Quality.LATCHED)
    stage.begin()
    stage.until(lambda: bool(first))
    stage.other.subscribe("kept_for_two", Map, second.append, Quality.LATCHED)
    stage.until(lambda: bool(second))
    assert [fields_of(each) for each in (*first, *second)] == [fields_of(sent)] * 2


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
    stage.until(lambda: min(kept.subscribers(), plain.subscribers()) > 0)
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
    stage.one.publish("greeted", float, on_subscriber=lambda: 0.5)
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
    stage.until(lambda: publisher.subscribers() == 1)
    closed.close()
    stage.until(lambda: publisher.subscribers() == 0)
    stage.other.subscribe("closed", int, got.append, Quality.EVERY)
    stage.until(lambda: publisher.subscribers() == 1)
    publisher.send(3)
    stage.until(lambda: got == [3])
    assert heard == []
