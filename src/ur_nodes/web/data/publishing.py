"""Messages that pages publish, through publishers that are kept for a while."""

from functools import partial

from ur.web.wire.data_requests import Publish
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node, Publisher
from ur_nodes.web.data.answers import Answer, Fields, RefusedError, refuse, refuse_uninstalled
from ur_nodes.web.data.forms import read_fields
from ur_nodes.web.data.guard import refuse_topic

_CONNECT_LIMIT = 1.0  # s for subscribers of a topic to connect to a new publisher
_CONNECT_EVERY = 0.02  # s between two looks for them
_KEPT = 30.0  # s for which a publisher is kept
_MOST_PUBLISHERS = 16

Message = Fields | bytes


class Publishing:
    """Publishes messages of pages, and keeps each publisher while pages use it."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._publishers: dict[tuple[str, str], tuple[Publisher[Message], float]] = {}
        node.every(1.0, self._expire, steady=True)

    def publish(self, request: Publish, graph: Graph, answer: Answer) -> None:
        """Publish a message once the subscribers of its topic are connected. Raises RefusedError and BadValueError."""
        topic = graph.topics.get(request.topic)
        refusal = refuse_topic(request.topic, request.kind, topic.subscribers if topic else ())
        if refusal:
            raise RefusedError(refusal)
        if topic is not None and topic.kind not in ("", request.kind):
            raise RefusedError(f"{request.topic} has the type {topic.kind}, not {request.kind}")
        fields = read_fields(request.value)

        def begin(schema: str | None) -> None:
            try:
                if schema is None:
                    raise refuse_uninstalled(request.kind)
                publisher, new = self._publisher(request.topic, request.kind)
            except RefusedError as problem:
                answer(refuse(str(problem)))
                return
            awaited = new and topic is not None and bool(topic.subscribers)
            self._send(publisher, fields, self._node.steady() + _CONNECT_LIMIT * awaited, answer)

        self._node.work(lambda: self._node.raw.find_schema(request.kind), begin, "schemas")

    def _send(self, publisher: Publisher[Message], fields: Fields, deadline: float, answer: Answer) -> None:
        count = publisher.subscribers()
        if not count and self._node.steady() < deadline:
            again = partial(self._send, publisher, fields, deadline, answer)
            self._node.after(_CONNECT_EVERY, again, steady=True)
            return
        try:
            publisher.send(fields)
        except ValueError as problem:
            answer(refuse(f"value: {problem}"))
        else:
            answer({"text": f"published to {count} subscriber{'' if count == 1 else 's'}"})

    def _publisher(self, topic: str, kind: str) -> tuple[Publisher[Message], bool]:
        """Return the publisher of a topic, and whether it is new. Raises RefusedError."""
        before = self._publishers.get((topic, kind))
        if before is None and len(self._publishers) >= _MOST_PUBLISHERS:
            raise RefusedError(f"{_MOST_PUBLISHERS} topics are published from here, expected a pause of {_KEPT:g} s")
        publisher = before[0] if before else self._node.raw.publish(topic, kind)
        self._publishers[topic, kind] = publisher, self._node.steady()
        return publisher, before is None

    def _expire(self) -> None:
        now = self._node.steady()
        for key in [key for key, (_, used) in self._publishers.items() if now - used > _KEPT]:
            self._publishers.pop(key)[0].close()
