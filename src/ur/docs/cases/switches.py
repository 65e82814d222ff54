"""Arguments that enable nodes which no default starts: tried out, a few values at a time."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence

from ur.check.model import LaunchView
from ur.docs.cases.outline import Outline
from ur.launchfile.syntax import Element

MAX_CHANGED = 3
MAX_TRIES = 60
_WORD = re.compile(r"[A-Za-z_]\w*")
_LITERAL = re.compile(r"""['"]([^'"]*)['"]""")
_ARGUMENT = re.compile(r"""\barg\(\s*['"](\w+)['"]\s*\)""")
_OPPOSITE = {"true": "false", "false": "true", "1": "0", "0": "1"}
_BASE = frozenset({"robot_base", "robot_variant"})

Assignment = tuple[tuple[str, str], ...]


def list_assignments(element: Element, view: LaunchView, outline: Outline) -> Iterator[Assignment]:
    """Values that may turn an element on, fewest changes first: of the arguments that its conditions speak of."""
    domains = _find_domains(outline.raw_conditions.get(element.start, ()), view)
    tries = 0
    for count in range(1, min(MAX_CHANGED, len(domains)) + 1):
        for names in itertools.combinations(domains, count):
            for values in itertools.product(*(domains[name] for name in names)):
                tries += 1
                if tries > MAX_TRIES:
                    return
                yield tuple(zip(names, values, strict=True))


def _find_domains(conditions: Sequence[str], view: LaunchView) -> Mapping[str, tuple[str, ...]]:
    # By argument the values worth trying: the opposite of a flag, and every text that a condition compares with.
    texts = list(conditions)
    names: dict[str, None] = {}
    position = 0
    while position < len(texts):
        for name in _find_names(texts[position]):
            elements = view.declared.get(name, ())
            if not elements or name in names or (name in _BASE and "robot_base" in view.declared):
                continue
            value = elements[0].attributes.get("value")
            if value is not None:
                texts.append(value)  # follows from other arguments
            else:
                names[name] = None
        position += 1
        if position > 50:
            break
    literals = dict.fromkeys(literal for text in texts for literal in _LITERAL.findall(_ARGUMENT.sub("", text)))
    domains: dict[str, tuple[str, ...]] = {}
    for name in names:
        default = view.declared[name][0].attributes.get("default", "")
        opposite = _OPPOSITE.get(default.strip().lower())
        values = (opposite,) if opposite is not None else (*literals, "true", "false")
        domains[name] = tuple(value for value in values if value and value != default)
    return {name: values for name, values in domains.items() if values}


def _find_names(text: str) -> list[str]:
    """The words of a condition that may be arguments: a quoted one is, if it is that of `arg`."""
    return [*_ARGUMENT.findall(text), *_WORD.findall(_LITERAL.sub("", text))]
