"""Data of the robot for pages: what they show, and their requests."""

from ur.web.wire.data_frames import ALL, pack_json
from ur.web.wire.data_requests import Show, read_data_request
from ur.web.wire.reading import BadRequestError
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node
from ur_nodes.web.data.actions import DataActions
from ur_nodes.web.data.answers import Fields
from ur_nodes.web.data.topics import TopicWatch
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.scene.feed import SceneFeed
from ur_nodes.web.server_link import Outlet
from ur_nodes.web.status.feed import StatusFeed

_TICK = 0.05  # s
_GRAPH_EVERY = 2.0  # s


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
        self._actions = DataActions(node)
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

        def answer(found: Fields) -> None:
            value = {"t": "answer", "id": envelope.number, **found}
            try:
                self._outlet.send_frame(pack_json(page, "", value))
            except ValueError:  # a number that JSON lacks, of a parameter
                bad = {**value, "ok": False, "text": "not a finite number", "value": None}
                self._outlet.send_frame(pack_json(page, "", bad))

        self._actions.start(envelope.request, answer)

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
