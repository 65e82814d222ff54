"""Requests of pages, carried out on a bus."""

import json
from dataclasses import dataclass
from typing import Any

import pytest

from ur.web.wire.data_requests import (
    Call,
    DescribeMessage,
    DescribeService,
    GetParameter,
    ListParameters,
    ListServices,
    Publish,
    SetParameter,
)
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result
from ur_nodes.web.data.actions import DataActions, Request

STRING = "std_msgs/String"


@dataclass(frozen=True)
class Reconfigure:
    """As dynamic_reconfigure has it."""

    config: Any

    type_name = "dynamic_reconfigure/Reconfigure"


class ActionsWorld:
    def __init__(self) -> None:
        self.bus = Bus()
        self.bus.schemas[STRING] = "string data\n"
        self.other = self.bus.node("other")
        self.node = self.bus.node("web")
        self.actions = DataActions(self.node)

    def ask(self, request: Request) -> dict[str, Any]:
        """The answer to a request."""
        answers: list[Any] = []
        self.actions.start(request, answers.append)
        assert self.bus.run_until(lambda: bool(answers), 10.0)
        (answer,) = answers
        return dict(answer)


def test_services_of_other_nodes_are_listed() -> None:
    world = ActionsWorld()
    world.other.serve("reset", Trigger, lambda _: Result(True))
    world.node.serve("own", Trigger, lambda _: Result(True))
    assert world.ask(ListServices()) == {"ok": True, "text": "", "value": ["/reset"]}


def test_parameters_are_listed_read_and_set() -> None:
    world = ActionsWorld()
    world.bus.parameters.update({"/camera/gain": 2, "/name": "robot"})
    assert world.ask(ListParameters())["value"] == ["/camera/gain", "/name"]
    assert json.loads(world.ask(GetParameter("/camera"))["value"]) == {"gain": 2}
    assert world.ask(SetParameter("/camera/gain", "3"))["text"].startswith("set; ")
    assert world.bus.parameters["/camera/gain"] == 3
    missing = world.ask(GetParameter("/nothing"))
    assert (missing["ok"], missing["text"]) == (False, "/nothing is not set")


def test_long_value_of_a_parameter_is_cut() -> None:
    world = ActionsWorld()
    world.bus.parameters["/long"] = "x" * 30_000
    answer = world.ask(GetParameter("/long"))
    assert not answer["whole"]
    assert len(answer["value"]) == 20_003


@pytest.mark.parametrize(
    ("request_", "text"),
    [
        (SetParameter("/run_id", '"x"'), "it belongs to the run"),
        (SetParameter("/x", "null"), "value: null"),
        (SetParameter("/x", "{"), "value: expected JSON"),
        (Publish("/cmd_vel", STRING, "{}"), "its name is that of what moves a base"),
        (Publish("/words", "no_such/Type", "{}"), "no_such/Type is not installed on this computer"),
        (Publish("/words", STRING, "[]"), "value: expected a JSON object"),
        (Publish("/words", STRING, '{"colour": 1}'), "value: No field name [colour]"),
        (Call("/cmd_vel_mux/release", "{}"), "ends an emergency stop"),
        (Call("/nothing", "{}"), "/nothing: no node offers it now"),
        (Call("/reset", '{"colour": 1}'), "value: "),
        (DescribeMessage("no_such/Type"), "no_such/Type is not installed on this computer"),
        (DescribeService("/nothing"), "/nothing: no node offers it now"),
    ],
)
def test_request_is_refused_with_its_reason(request_: Request, text: str) -> None:
    world = ActionsWorld()
    world.other.serve("reset", Trigger, lambda _: Result(True))
    answer = world.ask(request_)
    assert not answer["ok"]
    assert text in answer["text"]
    assert world.bus.parameters == {}


def test_types_are_described_by_their_empty_values() -> None:
    world = ActionsWorld()
    assert world.ask(DescribeMessage(STRING)) == {"ok": True, "text": "", "value": {"data": ""}, "kind": STRING}
    world.bus.schemas[Reconfigure.type_name] = "string config\n"
    world.other.serve("tune", Reconfigure, lambda _: Result(True))
    answer = world.ask(DescribeService("/tune"))
    assert (answer["value"], answer["kind"]) == ({"config": ""}, Reconfigure.type_name)


def test_message_is_published_to_those_who_listen() -> None:
    world, got = ActionsWorld(), list[RawMessage]()
    world.other.raw.subscribe("words", got.append, Quality.EVERY)
    assert world.ask(Publish("/words", STRING, '{"data": "one"}'))["text"] == "published to 1 subscriber"
    assert world.ask(Publish("/words", STRING, '{"data": "two"}'))["text"] == "published to 1 subscriber"
    world.bus.run(0.1)
    assert [json.loads(each.data)["data"] for each in got] == ["one", "two"]
    assert world.ask(Publish("/silence", STRING, "{}"))["text"] == "published to 0 subscribers"


def test_message_of_another_type_than_the_topic_has_is_refused() -> None:
    world = ActionsWorld()
    world.bus.schemas["std_msgs/Bool"] = "bool data\n"
    world.other.raw.publish("words", STRING)
    answer = world.ask(Publish("/words", "std_msgs/Bool", "{}"))
    assert answer["text"] == "/words has the type std_msgs/String, not std_msgs/Bool"


def test_publishers_are_limited_and_end_after_a_pause() -> None:
    world = ActionsWorld()
    for number in range(16):
        assert world.ask(Publish(f"/words{number}", STRING, "{}"))["ok"]
    assert "expected a pause" in world.ask(Publish("/more", STRING, "{}"))["text"]
    world.bus.run(32.0)
    assert world.ask(Publish("/more", STRING, "{}"))["ok"]


def test_service_is_called_and_its_answer_shown() -> None:
    world = ActionsWorld()
    world.other.serve("reset", Trigger, lambda _: Result(False, "no reason"))
    answer = world.ask(Call("/reset", "{}"))
    assert answer["ok"]
    assert answer["text"].startswith("Trigger, 0.00 s\n")
    assert "no reason" in answer["text"]


def test_requests_without_an_answer_are_limited() -> None:
    world, answers = ActionsWorld(), list[Any]()
    world.other.serve_later("slow", Trigger, lambda _request, _give: None)
    for _ in range(5):
        world.actions.start(Call("/slow", "{}"), answers.append)
    world.bus.run(60.0)
    assert [each["text"] for each in answers] == ["4 requests have no answer yet, expected them first"]


def test_parameter_of_a_node_that_can_be_tuned_changes_while_it_runs() -> None:
    world, got = ActionsWorld(), list[Any]()
    world.bus.parameters["/camera/gain"] = 2.0

    def tune(request: Reconfigure) -> Result:
        got.append(request.config)
        return Result(True, value={"config": {"doubles": [{"name": "gain", "value": 2.5}]}})

    world.other.serve("/camera/set_parameters", Reconfigure, tune)
    assert world.ask(SetParameter("/camera/gain", "3"))["text"] == "the node has taken 2.5"
    assert got == [{"doubles": [{"name": "gain", "value": 3.0}]}]
    assert "expected a number, text" in world.ask(SetParameter("/camera/gain", "[1]"))["text"]
