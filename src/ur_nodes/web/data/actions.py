"""Answers to pages that ask for names, types and values, and that publish, call services or set parameters."""

import json
from collections.abc import Callable
from functools import partial
from typing import Any

from ur.web.wire.data_requests import (
    Call,
    DescribeMesh,
    DescribeMessage,
    DescribeModel,
    DescribeService,
    GetParameter,
    ListParameters,
    ListServices,
    Publish,
    Question,
    SetParameter,
)
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node
from ur_nodes.ports.raw import ServiceAnswer, ServiceType
from ur_nodes.ports.values import Result
from ur_nodes.web.data.answers import Answer, Fields, RefusedError, attempt, refuse, refuse_uninstalled
from ur_nodes.web.data.forms import BadValueError, make_template, read_fields, read_value
from ur_nodes.web.data.guard import refuse_parameter, refuse_service
from ur_nodes.web.data.publishing import Publishing
from ur_nodes.web.messages.definition import read_definition
from ur_nodes.web.scene.robot_model import describe_mesh, describe_model

_MOST_CALLS = 4  # that have no answer yet
_LONGEST_TEXT = 20_000
_MOST_NAMES = 2000
_TUNED = "dynamic_reconfigure/Reconfigure"
_TUNED_FIELDS = {bool: "bools", int: "ints", float: "doubles", str: "strs"}
_LANE = "requests"
_UNSET = object()

Request = Question | Publish | Call | SetParameter


class DataActions:
    """Carries out requests of pages; `guard` decides which are refused."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._parameters = node.parameters.of("")
        self._publishing = Publishing(node)
        self._running = 0

    def start(self, request: Request, answer: Answer) -> None:
        """Carry out a request and call `answer` with its result: `ok`, `text`, and `value` where a form needs it."""
        if self._running >= _MOST_CALLS:
            answer({"ok": False, "text": f"{_MOST_CALLS} requests have no answer yet, expected them first"})
            return
        self._running += 1

        def finish(found: Fields) -> None:
            self._running -= 1
            answer({"ok": True, "text": "", **found})

        self._begin(request, finish)

    def _begin(self, request: Request, finish: Answer) -> None:
        if isinstance(request, ListServices | Publish | SetParameter):
            self._node.read_graph(lambda graph: self._guard(partial(self._use, request, graph, finish), finish))
        elif isinstance(request, DescribeService):
            self._node.raw.find_service(
                request.service, lambda result: finish(attempt(lambda: _describe_service(result)))
            )
        elif isinstance(request, Call):
            self._guard(partial(self._call, request, finish), finish)
        else:
            self._node.work(lambda: attempt(partial(self._look_up, request)), finish, _LANE)

    def _guard(self, begin: Callable[[], None], finish: Answer) -> None:
        """Begin a request; where it is refused, finish it with the reason."""
        try:
            begin()
        except (RefusedError, BadValueError) as problem:
            finish(refuse(str(problem)))

    def _use(self, request: ListServices | Publish | SetParameter, found: Graph | None, finish: Answer) -> None:
        if found is None:
            raise RefusedError("the master does not answer, expected it to list the nodes")
        graph = found.without(self._node.name)
        if isinstance(request, ListServices):
            finish({"value": [name[:200] for name in graph.services][:_MOST_NAMES]})
        elif isinstance(request, Publish):
            self._publishing.publish(request, graph, finish)
        else:
            self._set(request, graph, finish)

    def _look_up(self, request: Question) -> Fields:
        """Answer a question that may wait for the master or the disk; runs on a worker."""
        if isinstance(request, ListParameters):
            return {"value": [name[:200] for name in self._parameters.names()][:_MOST_NAMES]}
        if isinstance(request, GetParameter):
            value = self._parameters.any(request.name[1:], _UNSET)
            if value is _UNSET:
                raise RefusedError(f"{request.name} is not set")
            return _write_value(value)
        if isinstance(request, DescribeMessage):
            schema = self._node.raw.find_schema(request.kind)
            if schema is None:
                raise refuse_uninstalled(request.kind)
            return {"value": make_template(read_definition(request.kind, schema)), "kind": request.kind}
        if isinstance(request, DescribeModel):
            return describe_model(self._parameters.any("robot_description"))
        assert isinstance(request, DescribeMesh), "the others are no questions of this sort"
        return describe_mesh(request.address, self._parameters.any("robot_description"))

    def _call(self, request: Call, finish: Answer) -> None:
        refusal = refuse_service(request.service)
        if refusal:
            raise RefusedError(refusal)
        began = self._node.steady()

        def on_result(result: Result) -> None:
            answer = result.value
            if not result.success or not isinstance(answer, ServiceAnswer):
                finish(refuse(result.text))
                return
            seconds = self._node.steady() - began
            finish({"text": f"{answer.type_name}, {seconds:.2f} s\n{result.text[:_LONGEST_TEXT]}"})

        self._node.raw.call(request.service, read_fields(request.value), on_result)

    def _set(self, request: SetParameter, graph: Graph, finish: Answer) -> None:
        refusal = refuse_parameter(request.name)
        if refusal:
            raise RefusedError(refusal)
        value = read_value(request.value)
        if value is None:
            raise BadValueError("value: null, expected a number, text, true, false, list or object")
        service = f"{request.name.rpartition('/')[0]}/set_parameters"
        if service in graph.services:
            self._node.raw.find_service(service, partial(self._set_or_tune, request.name, value, service, finish))
        else:
            self._keep(request.name, value, finish)

    def _set_or_tune(self, name: str, value: object, service: str, finish: Answer, found: Result) -> None:
        if not isinstance(found.value, ServiceType) or found.value.name != _TUNED:
            self._keep(name, value, finish)
        elif type(value) not in _TUNED_FIELDS:
            finish(refuse("value: expected a number, text, true or false"))
        else:
            take = partial(self._tune, name, value, service, finish)
            self._node.work(lambda: self._parameters.any(name[1:], value), take, _LANE)

    def _tune(self, name: str, value: object, service: str, finish: Answer, before: object) -> None:
        """Change a parameter of a running node through dynamic_reconfigure."""
        last = name.rpartition("/")[2]
        if type(value) is int and isinstance(before, float):
            value = float(value)
        part = _TUNED_FIELDS[type(value)]

        def on_result(result: Result) -> None:
            if not result.success or not isinstance(result.value, ServiceAnswer):
                finish(refuse(result.text))
                return
            config: Any = result.value.fields["config"]
            group = config[part]
            kept = next((each["value"] for each in group if each["name"] == last), None)
            finish({"text": f"the node has taken {kept}"})

        self._node.raw.call(service, {"config": {part: [{"name": last, "value": value}]}}, on_result)

    def _keep(self, name: str, value: object, finish: Answer) -> None:
        def keep() -> Fields:
            self._parameters.keep(name[1:], value)
            return {"text": "set; a node that has read it before keeps the old value until it starts again"}

        self._node.work(lambda: attempt(keep), finish, _LANE)


def _describe_service(found: Result) -> Fields:
    if not isinstance(found.value, ServiceType):
        return refuse(found.text)
    kind = found.value
    return {"value": make_template(read_definition(f"{kind.name}Request", kind.schema)), "kind": kind.name}


def _write_value(value: object) -> Fields:
    text = json.dumps(value, ensure_ascii=False, default=str, indent=1 if isinstance(value, (dict, list)) else None)
    whole = len(text) <= _LONGEST_TEXT
    return {"value": text if whole else f"{text[:_LONGEST_TEXT]}...", "whole": whole}
