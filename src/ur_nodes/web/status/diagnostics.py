"""The newest diagnostics of each component, from decoded messages of the type diagnostic_msgs/DiagnosticArray."""

from collections.abc import Mapping

from ur.source.printable import printable
from ur_nodes.web.messages.decode import Bounds, Cut
from ur_nodes.web.status.computer import LEVELS

KIND = "diagnostic_msgs/DiagnosticArray"
BOUNDS = Bounds(items=200, letters=300, values=8000)
STALE = 10.0
"""Seconds without a word after which a component counts as stale."""

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
