"""Wiring of a base's wheels: what is swapped or reversed between a board and its wheels, as a base file names it.

The names are those of the robot: the left wheel is the left one of the robot.
"""

from dataclasses import dataclass, fields, replace
from pathlib import Path

import yaml

from ur.source.foreign.yaml_text import compose_yaml
from ur.source.read import read_source
from ur.source.replace import replace_file


@dataclass(frozen=True, slots=True)
class Wiring:
    """The differences from a robot that is wired as its board expects; all of them False for such a robot.

    `motors_swapped`: the board's left motor output turns the right wheel, and the reverse; `counters_swapped` likewise.
    A reversed motor turns its wheel backward for a positive speed; a reversed counter counts down forward.
    """

    motors_swapped: bool = False
    left_motor_reversed: bool = False
    right_motor_reversed: bool = False
    counters_swapped: bool = False
    left_counter_reversed: bool = False
    right_counter_reversed: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what differs."""
        return tuple(name for name in WIRING_NAMES if getattr(self, name))

    def command(self, left: float, right: float) -> tuple[float, float]:
        """Return the speeds that the board gets, for those of the wheels."""
        left = -left if self.left_motor_reversed else left
        right = -right if self.right_motor_reversed else right
        return (right, left) if self.motors_swapped else (left, right)

    def turned(self, left: float, right: float) -> tuple[float, float]:
        """Return what the wheels do, for speeds that the board gets."""
        left, right = (right, left) if self.motors_swapped else (left, right)
        return -left if self.left_motor_reversed else left, -right if self.right_motor_reversed else right

    def counted(self, left: int, right: int) -> tuple[int, int]:
        """Return the counts of the wheels, for those that the board reports."""
        left, right = (right, left) if self.counters_swapped else (left, right)
        return -left if self.left_counter_reversed else left, -right if self.right_counter_reversed else right


WIRING_NAMES = tuple(field.name for field in fields(Wiring))


def put_wiring(text: str, variant: str, wiring: Wiring) -> str:
    """Return a base file's text with the wiring in the `driver` of a variant ('': the plain base).

    Only the value of `driver` changes; it becomes one line. Raises LookupError: there is no driver.
    """
    root = compose_yaml(text)
    node = _find(root, "variants", variant, "driver") if variant else None
    node = node or _find(root, "driver")
    if node is None:
        raise LookupError("driver")
    if isinstance(node, yaml.MappingNode):
        pairs = {str(key.value): text[value.start_mark.index : value.end_mark.index] for key, value in node.value}
    else:
        pairs = {"protocol": str(node.value)}
    pairs.pop("wiring", None)
    if wiring.names:
        pairs["wiring"] = "{" + ", ".join(f"{name}: true" for name in wiring.names) + "}"
    line = "{" + ", ".join(f"{key}: {value.strip()}" for key, value in pairs.items()) + "}"
    line = pairs["protocol"] if list(pairs) == ["protocol"] else line
    begin, end = node.start_mark.index, _end_of(node)
    if "\n" in text[text.rindex(":", 0, begin) : begin]:  # a block mapping begins on the next line
        begin = text.rindex(":", 0, begin) + 1
        line = f" {line}"
    return text[:begin] + line + text[end:]


def write_wiring(path: Path, variant: str, wiring: Wiring) -> None:
    """Put the wiring into a base file, in one step. Raises UserError, OSError, and LookupError as put_wiring."""
    text = read_source(path, "a base file", piped=False).text
    replace_file(path, put_wiring(text, variant, wiring))


def find_wirings(observed: tuple[tuple[tuple[int, int], tuple[int, int], tuple[int, int]], ...]) -> list[Wiring]:
    """Find the wirings that explain what was observed: the signs that the board got, of the wheels, of its counters."""
    every = [Wiring()]
    for name in WIRING_NAMES:
        every += [replace(each, **{name: True}) for each in every]
    return [
        each
        for each in every
        if all(
            each.turned(*given) == wheels and each.counted(*counters) == wheels for given, wheels, counters in observed
        )
    ]


def _end_of(node: yaml.Node) -> int:
    """The end of a value; that of a block mapping is the end of its last value, before the comments that follow."""
    if isinstance(node, yaml.MappingNode) and not node.flow_style and node.value:
        return _end_of(node.value[-1][1])
    return int(node.end_mark.index)


def _find(root: yaml.Node | None, *keys: str) -> yaml.Node | None:
    node = root
    for key in keys:
        pairs = node.value if isinstance(node, yaml.MappingNode) else []
        node = next((value for name, value in pairs if name.value == key), None)
    return node
