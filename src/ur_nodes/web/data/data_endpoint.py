"""Data of the robot for pages: what they show, and the shapes of its model."""

from collections.abc import Mapping
from functools import partial

from ur.source.printable import printable
from ur.web.wire.data_requests import ALL, DescribeModel, Question, Show, pack_json, read_data_request
from ur.web.wire.reading import BadRequestError
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node
from ur_nodes.web.data.diagnostics import StatusFeed
from ur_nodes.web.data.topics import TopicWatch
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.scene.feed import SceneFeed
from ur_nodes.web.scene.robot_model import describe_mesh, describe_model
from ur_nodes.web.server_link import Outlet

_TICK = 0.05  # s
_GRAPH_EVERY = 2.0  # s
_MOST_QUESTIONS = 4  # that have no answer yet


class DataSession:
    """Sends pages the data that they show, and answers their requests, through the server."""

    def __init__(self, node: Node, outlet: Outlet) -> None:
        self._node, self._outlet = node, outlet
        self._shows: dict[int, Show] = {}
        self._graph: Graph | None = None  # since a page shows anything
        self._asking = False
        self._graph_every = Every(_GRAPH_EVERY)
        send = outlet.send_frame
        self._topics, self._status, self._scene = TopicWatch(node, send), StatusFeed(node, send), SceneFeed(node, send)
        self._parameters, self._running = node.parameters.of(""), 0
        send(pack_json(ALL, "hello", {"t": "hello"}))
        node.every(_TICK, self._step, steady=True)

    def receive(self, message: dict[str, object]) -> None:
        """Take a message of a page: its number, and a request as text; "" after it has disconnected."""
        page, text = int(str(message["page"])), str(message["m"])
        if not text:
            self._shows.pop(page, None)
            return
        try:
            envelope = read_data_request(text)
        except BadRequestError:
            return  # the server has let only good ones through
        if isinstance(envelope.request, Show):
            self._shows[page] = envelope.request
            self._topics.hurry()
            return

        answer = partial(self._answer, page, envelope.number)
        if self._running >= _MOST_QUESTIONS:
            answer({"ok": False, "text": f"{_MOST_QUESTIONS} requests have no answer yet, expected them first"})
            return
        self._running += 1

        def finish(found: Mapping[str, object]) -> None:
            self._running -= 1
            answer(found)

        self._node.work(partial(self._look_up, envelope.request), finish, "requests")

    def _answer(self, page: int, number: int, found: Mapping[str, object]) -> None:
        value = {"t": "answer", "id": number, "ok": True, "text": "", **found}
        try:
            self._outlet.send_frame(pack_json(page, "", value))
        except ValueError:  # a number that JSON lacks
            bad = {**value, "ok": False, "text": "not a finite number", "value": None}
            self._outlet.send_frame(pack_json(page, "", bad))

    def _look_up(self, request: Question) -> Mapping[str, object]:
        """Describe the model or a mesh of it; runs on a worker, since it may wait for the master or the disk."""
        try:
            description = self._parameters.any("robot_description")
            if isinstance(request, DescribeModel):
                return describe_model(description)
            return describe_mesh(request.address, description)
        except Exception as problem:  # a master may answer anything
            return {"ok": False, "text": printable(str(problem))[:1000]}

    def _step(self) -> None:
        if not self._shows:
            self._graph = None
            self._graph_every.hurry()
        elif not self._asking and self._graph_every.due(self._node.steady()):
            self._asking = True
            self._node.read_graph(self._on_graph)
        if self._outlet.busy:
            return
        self._status.step([page for page, each in self._shows.items() if each.status])
        if self._graph is not None or not self._shows:
            graph = self._graph or Graph()
            self._topics.step(self._shows, graph)
            self._scene.step(self._shows, dict(graph.published()))

    def _on_graph(self, graph: Graph | None) -> None:
        self._asking = False
        self._graph = graph.without(self._node.name) if graph is not None else self._graph or Graph()
