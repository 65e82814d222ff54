"""Changes that pages ask for: messages published, services called, parameters set. `guard` says what is refused."""

from __future__ import annotations

import io
import json
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

import genpy
import rospy
from roslib.message import get_message_class, get_service_class
from rosservice import ROSServiceException, get_service_type

from ur.source.printable import printable
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
from ur_nodes.ros1.installed import has_generated
from ur_nodes.web.data.forms import BadValueError, make_template, read_fields, read_value
from ur_nodes.web.data.graph_node import RosGraph
from ur_nodes.web.data.guard import refuse_parameter, refuse_service, refuse_topic
from ur_nodes.web.scene.scene_node import describe_mesh, describe_model

_CONNECT_LIMIT = 1.0  # s for subscribers of a topic to connect to a new publisher
_KEPT = 30.0  # s for which a publisher is kept
_MOST_PUBLISHERS = 16
_MOST_CALLS = 4  # that have no answer yet
_LONGEST_TEXT = 20_000
_MOST_NAMES = 2000
_TUNED = "dynamic_reconfigure/Reconfigure"

Answer = Callable[[Mapping[str, Any]], None]
Request = Question | Publish | Call | SetParameter


class RefusedError(Exception):
    """A request that is not carried out; the text says why, in a line."""


class Actions:
    """Carries requests out, each in a thread of its own: services may take their time. `graph` gives the newest one."""

    def __init__(self, graph: Callable[[], RosGraph]) -> None:
        self._graph = graph
        self._lock = threading.Lock()
        self._publishers: dict[tuple[str, str], tuple[rospy.Publisher, float]] = {}
        self._running = 0

    def take(self, request: Request, answer: Answer) -> None:
        """Carry a request out, and pass its answer on: `ok` and `text`, and `value` where a form needs it."""
        with self._lock:
            if self._running >= _MOST_CALLS:
                answer({"ok": False, "text": f"{_MOST_CALLS} requests have no answer yet, expected them first"})
                return
            self._running += 1
        threading.Thread(target=self._run, args=(request, answer), name="request", daemon=True).start()

    def _run(self, request: Request, answer: Answer) -> None:
        try:
            found = self._carry_out(request)
        except (
            RefusedError,
            BadValueError,
            ROSServiceException,
            rospy.ServiceException,
            rospy.ROSException,
        ) as problem:
            found = {"ok": False, "text": printable(str(problem))[:1000]}
        except (genpy.MessageException, KeyError, OSError) as problem:
            found = {"ok": False, "text": printable(f"value: {problem}")[:1000]}
        finally:
            with self._lock:
                self._running -= 1
        answer({"ok": True, "text": "", **found})

    def expire(self, now: float) -> None:
        """End publishers that no page has used for a while."""
        with self._lock:
            old = [key for key, (_, used) in self._publishers.items() if now - used > _KEPT]
            ended = [self._publishers.pop(key)[0] for key in old]
        for publisher in ended:
            publisher.unregister()

    def _carry_out(self, request: Request) -> Mapping[str, Any]:
        if isinstance(request, ListServices):
            return {"value": [name[:200] for name in self._graph().services[:_MOST_NAMES]]}
        if isinstance(request, ListParameters):
            return {"value": sorted(str(name)[:200] for name in rospy.get_param_names())[:_MOST_NAMES]}
        if isinstance(request, GetParameter):
            return _get(request.name)
        if isinstance(request, DescribeMessage):
            return {"value": make_template(_find_message(request.kind), get_message_class), "kind": request.kind}
        if isinstance(request, DescribeService):
            kind, found = _find_service(request.service)
            return {"value": make_template(found._request_class, get_message_class), "kind": kind}  # noqa: SLF001 - genpy's
        if isinstance(request, DescribeModel):
            return describe_model()
        if isinstance(request, DescribeMesh):
            return describe_mesh(request.address)
        if isinstance(request, Publish):
            return self._publish(request)
        return _call(request) if isinstance(request, Call) else _set(request, self._graph())

    def _publish(self, request: Publish) -> Mapping[str, Any]:
        topic = self._graph().topics.get(request.topic)
        refusal = refuse_topic(request.topic, request.kind, topic.subscribers if topic else ())
        if refusal:
            raise RefusedError(refusal)
        if topic is not None and topic.kind not in ("", request.kind):
            raise RefusedError(f"{request.topic} has the type {topic.kind}, expected that, not {request.kind}")
        message = _fill(_find_message(request.kind)(), request.value)
        publisher, new = self._publisher(request.topic, type(message), request.kind)
        deadline = time.monotonic() + (_CONNECT_LIMIT if new and topic and topic.subscribers else 0.0)
        while publisher.get_num_connections() == 0 and time.monotonic() < deadline:
            time.sleep(0.02)
        publisher.publish(message)
        count = publisher.get_num_connections()
        return {"text": f"published to {count} subscriber{'' if count == 1 else 's'}"}

    def _publisher(self, topic: str, found: Any, kind: str) -> tuple[rospy.Publisher, bool]:
        with self._lock:
            before = self._publishers.get((topic, kind))
            if before is None and len(self._publishers) >= _MOST_PUBLISHERS:
                raise RefusedError(
                    f"{_MOST_PUBLISHERS} topics are published from here, expected a pause of {_KEPT:g} s"
                )
            publisher = before[0] if before else rospy.Publisher(topic, found, queue_size=5)
            self._publishers[topic, kind] = publisher, time.monotonic()
            return publisher, before is None


def _find_message(kind: str) -> Any:
    found = get_message_class(kind) if has_generated(kind, "msg") else None
    if found is None:
        raise RefusedError(f"{kind} is not installed on this computer, expected its package")
    return found


def _find_service(name: str) -> tuple[str, Any]:
    kind = get_service_type(name)
    if kind is None:
        raise RefusedError(f"{name}: no node offers it now")
    found = get_service_class(kind) if has_generated(str(kind), "srv") else None
    if found is None:
        raise RefusedError(f"{name}: {kind} is not installed on this computer, expected its package")
    return str(kind), found


def _fill(message: Any, text: str) -> Any:
    """A message with the fields of a JSON text, as it can be sent; a stamp that is zero becomes now."""
    fields = read_fields(text)
    genpy.message.fill_message_args(message, [fields] if fields else [])
    header: Any = getattr(message, "header", None)
    if isinstance(getattr(header, "stamp", None), genpy.Time) and header.stamp.is_zero():
        header.stamp = rospy.Time.now()
    try:
        message.serialize(io.BytesIO())
    except (genpy.SerializationError, TypeError, ValueError) as problem:
        raise BadValueError(f"value: {problem}") from None
    return message


def _call(request: Call) -> Mapping[str, Any]:
    refusal = refuse_service(request.service)
    if refusal:
        raise RefusedError(refusal)
    kind, found = _find_service(request.service)
    asked = _fill(found._request_class(), request.value)  # noqa: SLF001 - genpy has no other name
    began = time.monotonic()
    answer = rospy.ServiceProxy(request.service, found)(asked)
    return {"text": f"{kind}, {time.monotonic() - began:.2f} s\n{str(answer)[:_LONGEST_TEXT]}"}


def _get(name: str) -> Mapping[str, Any]:
    value = rospy.get_param(name)
    text = json.dumps(value, ensure_ascii=False, default=str, indent=1 if isinstance(value, (dict, list)) else None)
    whole = len(text) <= _LONGEST_TEXT
    return {"value": text if whole else f"{text[:_LONGEST_TEXT]}...", "whole": whole}


def _set(request: SetParameter, graph: RosGraph) -> Mapping[str, Any]:
    refusal = refuse_parameter(request.name)
    if refusal:
        raise RefusedError(refusal)
    value = read_value(request.value)
    if value is None:
        raise BadValueError("value: null, expected a number, text, true, false, list or object")
    node, _, last = request.name.rpartition("/")
    service = f"{node}/set_parameters"
    if service in graph.services and get_service_type(service) == _TUNED:
        return _tune(service, last, value)
    rospy.set_param(request.name, value)
    return {"text": "set; a node that has read it before keeps the old value until it starts again"}


def _tune(service: str, name: str, value: Any) -> Mapping[str, Any]:
    """Change a parameter of a node while it runs, by dynamic_reconfigure."""
    _, found = _find_service(service)
    kinds = {bool: "bools", int: "ints", float: "doubles", str: "strs"}
    before = rospy.get_param(f"{service.rpartition('/')[0]}/{name}", value)
    if type(value) is int and isinstance(before, float):
        value = float(value)
    if type(value) not in kinds:
        raise BadValueError("value: expected a number, text, true or false")
    fields = {"config": {kinds[type(value)]: [{"name": name, "value": value}]}}
    answer = rospy.ServiceProxy(service, found)(_fill(found._request_class(), json.dumps(fields)))  # noqa: SLF001 - genpy's
    group = getattr(answer.config, kinds[type(value)])
    kept = next((each.value for each in group if each.name == name), None)
    return {"text": f"the node has taken {kept}"}
