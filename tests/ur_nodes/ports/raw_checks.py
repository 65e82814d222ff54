"""Checks of messages of any type, and of the graph."""

import pytest
from tests.ur_nodes.ports.stage import Stage

from ur_nodes.ports.graph import Graph
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result


def check_raw_message_has_bytes_type_schema_and_sender(stage: Stage) -> None:
    got: list[RawMessage] = []
    publisher = stage.one.raw.publish("raw", stage.string_type, Quality.LATCHED)
    publisher.send(stage.wire)
    stage.other.raw.subscribe("raw", got.append)
    stage.begin()
    stage.until(lambda: bool(got))
    (message,) = got
    assert (message.type_name, message.data) == (stage.string_type, stage.wire)
    assert "string data" in message.schema
    if stage.raw_senders_unknown:
        assert message.sender is None
    else:
        assert message.sender is not None
        assert message.sender.name == stage.one.name
        assert message.sender.kept


def check_raw_message_is_made_of_fields(stage: Stage) -> None:
    got: list[RawMessage] = []
    publisher = stage.one.raw.publish("fields", stage.string_type)
    stage.other.raw.subscribe("fields", got.append, Quality.EVERY)
    stage.begin()
    stage.until(lambda: publisher.subscribers() == 1)
    with pytest.raises(ValueError, match="colour"):
        publisher.send({"colour": 1})
    for wrong in ([1], {"data": "hello"}, 1):
        with pytest.raises(ValueError, match=r"str|text|encode|int"):
            publisher.send({"data": wrong})
    publisher.send({"data": "hello"})
    publisher.send({"data": "again"})
    stage.until(lambda: len(got) == 2)
    assert [word in each.data for word, each in zip((b"hello", b"again"), got, strict=True)] == [True, True]


def check_raw_type_must_be_installed(stage: Stage) -> None:
    assert "string data" in (stage.one.raw.find_schema(stage.string_type) or "")
    assert stage.one.raw.find_schema("no_such_package/Sensor") is None
    with pytest.raises(LookupError):
        stage.one.raw.publish("uninstalled", "no_such_package/Sensor")


def check_topic_is_heard_raw_and_by_its_kind(stage: Stage) -> None:
    raw: list[RawMessage] = []
    typed: list[str] = []
    publisher = stage.one.publish("both", str, Quality.EVERY)
    stage.other.raw.subscribe("both", raw.append)
    stage.other.subscribe("both", str, typed.append)
    stage.begin()
    stage.until(lambda: publisher.subscribers() > 0)
    stage.one.every(0.05, lambda: publisher.send("hello"))
    stage.until(lambda: bool(raw and typed))
    assert typed[0] == "hello"
    assert b"hello" in raw[0].data


def check_closed_raw_subscription_hears_nothing(stage: Stage) -> None:
    got: list[RawMessage] = []
    heard: list[RawMessage] = []
    publisher = stage.one.raw.publish("raw_closed", stage.string_type, Quality.LATCHED)
    stage.other.raw.subscribe("raw_closed", heard.append).close()
    stage.begin()
    publisher.send(stage.wire)
    stage.until(lambda: publisher.subscribers() == 0)
    stage.other.raw.subscribe("raw_closed", got.append)
    stage.until(lambda: bool(got))
    assert heard == []


def check_graph_has_both_ends_of_topics_and_services(stage: Stage) -> None:
    got: list[Graph | None] = []
    stage.one.raw.publish("drawn", stage.string_type)
    stage.other.subscribe("drawn", str, print)
    stage.other.subscribe("drawn_only_heard", str, print)
    stage.other.serve("drawn_service", Trigger, lambda _request: Result(True))
    stage.begin()
    stage.one.read_graph(got.append)
    stage.until(lambda: bool(got))
    graph = got[0]
    assert graph is not None
    topic = graph.topics["/drawn"]
    assert (topic.kind, topic.publishers, topic.subscribers) == (
        stage.string_type,
        (stage.one.name,),
        (stage.other.name,),
    )
    assert graph.topics["/drawn_only_heard"].publishers == ()
    assert ("/drawn", stage.string_type) in graph.published()
    assert "/drawn_only_heard" not in dict(graph.published())
    assert graph.services["/drawn_service"] == (stage.other.name,)
    assert {stage.one.name, stage.other.name} <= set(graph.nodes)
    others = graph.without(stage.one.name).without(stage.other.name)
    assert not {"/drawn", "/drawn_only_heard"} & others.topics.keys()
    assert "/drawn_service" not in others.services
    assert stage.one.name not in others.nodes
