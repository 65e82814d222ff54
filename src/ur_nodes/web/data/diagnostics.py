"""Diagnostics of the robot: the newest of each component, sent while a page shows them."""

from collections.abc import Callable, Collection, Mapping

from ur.source.printable import printable
from ur.web.wire.data_requests import pack_json
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.messages.decode import BadMessageError, Bounds, Cut, decode
from ur_nodes.web.messages.definition import BadDefinitionError, read_definition

KIND = "diagnostic_msgs/DiagnosticArray"
BOUNDS = Bounds(items=200, letters=300, values=8000)
STALE = 10.0
"""Seconds without a word after which a component counts as stale."""

LEVELS: Mapping[int, str] = {0: "ok", 1: "warn", 2: "error", 3: "stale"}
"""Of diagnostic_msgs/DiagnosticStatus, by its number."""

_MOST = 300  # components
_FORGOTTEN = 300.0  # s
_MOST_VALUES = 30  # of a component


class Diagnostics:
    """Components by name. Times are seconds of any steady clock."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[float, dict[str, object]]] = {}

    def receive(self, message: Mapping[str, object], now: float) -> None:
        """Take a decoded message; malformed parts are left out."""
        statuses = message.get("status")
        for each in _items(statuses):
            if not isinstance(each, dict) or not isinstance(each.get("name"), str):
                continue
            if isinstance(each.get("level"), int) and each["level"] in LEVELS:
                name = _text(each["name"])
                if name in self._known or len(self._known) < _MOST:
                    self._known[name] = (
                        now,
                        {
                            "name": name,
                            "level": LEVELS[each["level"]],
                            "text": _text(each.get("message")),
                            "hardware": _text(each.get("hardware_id")),
                            "values": [
                                [_text(pair.get("key")), _text(pair.get("value"))]
                                for pair in _items(each.get("values"))[:_MOST_VALUES]
                                if isinstance(pair, dict)
                            ],
                        },
                    )

    def describe(self, now: float) -> list[dict[str, object]]:
        """Return the components, the worst first. One that has stopped reporting becomes stale, then is forgotten."""
        self._known = {name: each for name, each in self._known.items() if now - each[0] < _FORGOTTEN}
        found = [{**each, **({"level": "stale"} if now - at > STALE else {})} for at, each in self._known.values()]
        order = ("error", "stale", "warn", "ok")
        return sorted(found, key=lambda each: (order.index(each["level"]), each["name"]))


def _items(value: object) -> list[object]:
    found = value.items if isinstance(value, Cut) else value
    return found if isinstance(found, list) else []


def _text(value: object) -> str:
    return printable(value)[:300] if isinstance(value, str) else ""


_EVERY = 2.0  # s
_TOPIC = "/diagnostics"
_LONGEST = 1 << 20  # bytes of a message
_LOGGED_EVERY = 10.0  # s


class StatusFeed:
    """Sends the status that pages show."""

    def __init__(self, node: Node, send: Callable[[bytes], None]) -> None:
        self._node, self._send = node, send
        self._every = Every(_EVERY)
        self._subscription: Subscription | None = None
        self._diagnostics = Diagnostics()
        self._pages: frozenset[int] = frozenset()

    def step(self, pages: Collection[int]) -> None:
        """Send the state to these pages; to be called often."""
        if pages and self._subscription is None:
            self._subscription = self._node.raw.subscribe(_TOPIC, self._on_message, Quality.EVERY)
        elif not pages and self._subscription is not None:
            self._subscription.close()
            self._subscription, self._diagnostics = None, Diagnostics()
        if set(pages) - self._pages:
            self._every.hurry()
        self._pages = frozenset(pages)
        if pages and self._every.due(self._node.steady()):
            components = self._diagnostics.describe(self._node.steady())
            for page in self._pages:
                self._send(pack_json(page, "status", {"t": "status", "components": components}))

    def _on_message(self, message: RawMessage) -> None:
        if message.type_name != KIND or len(message.data) > _LONGEST:
            return
        try:
            found = decode(read_definition(KIND, message.schema), message.data, BOUNDS)
        except (BadDefinitionError, BadMessageError) as problem:
            self._node.log.warn(f"{_TOPIC}: {problem}", every=_LOGGED_EVERY)
            return
        self._diagnostics.receive(found, self._node.steady())
