"""Components from decoded diagnostics, which may be anything."""

from typing import Any

from ur_nodes.web.data.diagnostics import Diagnostics
from ur_nodes.web.messages.decode import Cut


def component(name: Any = "a", level: Any = 0, **more: Any) -> dict[str, Any]:
    return {"name": name, "level": level, "message": "m", "hardware_id": "", "values": [], **more}


def test_worst_component_is_first_and_one_that_is_silent_is_stale_then_forgotten() -> None:
    found = Diagnostics()
    found.receive({"status": [component("a"), component("b", 2), component("c", 1)]}, 0.0)
    assert [each["level"] for each in found.describe(1.0)] == ["error", "warn", "ok"]
    found.receive({"status": [component("a")]}, 15.0)
    assert [(each["name"], each["level"]) for each in found.describe(16.0)] == [
        ("b", "stale"),
        ("c", "stale"),
        ("a", "ok"),
    ]
    assert [each["name"] for each in found.describe(310.0)] == ["a"]


def test_what_is_no_component_is_left_out_and_texts_are_bounded() -> None:
    found = Diagnostics()
    pairs = [{"key": "k" * 1000, "value": "\x1b[2J"}, {"key": 4}, "x"]
    good = component("<img>", values=Cut([*pairs, *pairs * 50], 500))
    found.receive({"status": Cut([None, {}, component(4), component(level=9), component(level=[]), good], 900)}, 0.0)
    shown: Any = found.describe(0.0)
    (only,) = shown
    assert only["values"][0] == ["k" * 300, "\\x1b[2J"]
    assert len(only["values"]) <= 30
    found.receive({}, 0.0)
    found.receive({"status": 4}, 0.0)


def test_components_are_bounded_in_number() -> None:
    found = Diagnostics()
    found.receive({"status": [component(f"c{number}") for number in range(1000)]}, 0.0)
    assert len(found.describe(0.0)) == 300
