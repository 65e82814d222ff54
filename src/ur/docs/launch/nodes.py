"""The nodes of one launch file: names, parameters, remaps and topics, in every case."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence

from ur.docs.cases.resolve import Resolution, ResolvedCase, find_node, list_switches
from ur.docs.documents import BaseCase, NodeDoc, ParamDoc, ParamFileDoc, TopicDoc, Value
from ur.docs.vary import vary
from ur.docs.words import Words
from ur.launchfile.plan.one_file import HERE
from ur.launchfile.plan.specs import NodeSpec, ParamSpec
from ur.launchfile.query.topics import NameUse, find_name_uses
from ur.launchfile.syntax import Element

_PIECE = re.compile(r"\$\([^)]{0,500}\)")
_USES = {
    "publishes": "publishes",
    "subscribes": "subscribes",
    "offers-service": "offers service",
    "calls-service": "calls service",
    "offers-action": "offers action",
    "uses-action": "uses action",
    "sends-frame": "sends frame",
    None: "uses",
}
_LONG = 80


class NodeDescriber:
    """Describes the nodes and parameters of one launch file. `find_inside`: a path from the root, None for others."""

    def __init__(
        self, outcomes: tuple[ResolvedCase, ...], words: Words, path: str, find_inside: Callable[[str], str | None]
    ) -> None:
        self.outcomes = outcomes
        self.words = words
        self.path = path
        self.find_inside = find_inside
        self.cases = tuple(outcome.case for outcome in outcomes)
        self.params: dict[int, list[tuple[ResolvedCase, ParamSpec]]] = {}  # by place, of the file itself
        self.loaded: list[tuple[ResolvedCase, ParamSpec]] = []  # from YAML files
        for outcome in outcomes:
            seen: set[str] = set()
            for resolution in outcome.resolutions:
                for param in resolution.plan.params:
                    if param.name in seen:
                        continue
                    seen.add(param.name)
                    if param.origin.span.file.path == path:
                        self.params.setdefault(param.origin.span.start, []).append((outcome, param))
                    else:
                        self.loaded.append((outcome, param))

    def describe(self, element: Element, conditions: tuple[str, ...]) -> NodeDoc:
        """Describe a `<node>` or `<test>`."""
        found = [(o, w, node) for o in self.outcomes for w in o.resolutions if (node := find_node(w, element.start))]
        first = _first_per_case(found)
        specs = [(outcome, node) for outcome, _, node in first]
        names = {node.full_name for _, node in specs}
        return NodeDoc(
            names=self.vary_or_written(specs, "full_name", element.attributes.get("name", "")),
            package=self.vary_or_written(specs, "package", element.attributes.get("pkg", "")),
            type=self.vary_or_written(specs, "type", element.attributes.get("type", "")),
            machine=_written_machine(element),
            conditions=conditions,
            only_with=list_switches((outcome, resolution) for outcome, resolution, _ in found),
            cases=tuple(outcome.case for outcome, resolution, _ in first if resolution is outcome.default),
            traits=tuple(_list_traits(element, [node for _, node in specs])),
            params=tuple(self.describe_params(element, names)),
            param_files=tuple(self.describe_param_files(element, names)),
            remaps=tuple(dict.fromkeys(self.show_remap(remap) for _, node in specs for remap in node.remaps)),
            topics=self.describe_topics(specs),
        )

    def vary_or_written(
        self, specs: Sequence[tuple[ResolvedCase, NodeSpec]], field: str, written: str
    ) -> tuple[Value, ...]:
        """Return an attribute of a node in every case; as written if the node never takes part."""
        if not specs:
            return (Value(written),)
        pairs = [(o.case, self.words.show(getattr(node, field), dict(o.given))) for o, node in specs]
        return vary(pairs, tuple(case for case, _ in pairs))

    def show_remap(self, remap: tuple[str, str]) -> tuple[str, str]:
        """Return a remap without paths of this computer."""
        return self.words.show(remap[0]), self.words.show(remap[1])

    def describe_params(self, around: Element, nodes: Iterable[str] = ()) -> Iterator[ParamDoc]:
        """Yield the parameters that are set in the file itself, directly inside an element."""
        prefixes = tuple(f"{name}/" for name in nodes)
        for element in around.elements:
            if element.name not in ("param", "rosparam"):
                continue
            places = [start for start in self.params if element.start <= start <= element.end]
            for start in sorted(places):
                yield from self.describe_param(element, self.params[start], prefixes)

    def describe_param(
        self, element: Element, found: list[tuple[ResolvedCase, ParamSpec]], prefixes: tuple[str, ...]
    ) -> Iterator[ParamDoc]:
        """Yield the parameters of a parameter tag; a mapping in `<rosparam>` contains several."""
        by_name: dict[str, list[tuple[BaseCase, str]]] = {}
        for outcome, param in found:
            name = self.show_name(param.name, prefixes)
            by_name.setdefault(name, []).append((outcome.case, self.show_value(element, param, outcome)))
        for name, pairs in by_name.items():
            yield ParamDoc(name, vary(pairs, self.cases))

    def show_name(self, name: str, prefixes: tuple[str, ...]) -> str:
        """Return `~rate` for a parameter of the node that contains it."""
        for prefix in prefixes:
            if name.startswith(prefix):
                return "~" + self.words.show(name[len(prefix) :])
        return self.words.show(name)

    def show_value(self, element: Element, param: ParamSpec, outcome: ResolvedCase) -> str:
        """Return the value; the output of a program or the content of a file is shown as written in the tag."""
        for attribute in ("command", "textfile", "binfile"):
            if element.name == "param" and attribute in element.attributes:
                what = "what this prints: " if attribute == "command" else "the content of "
                return what + " ".join(element.attributes[attribute].split())
        value = param.value
        text = value if isinstance(value, str) else _show_plain(value)
        text = " ".join(self.words.show(text, dict(outcome.given)).split())
        return text if len(text) <= _LONG else text[: _LONG - 4] + " ..."

    def describe_param_files(self, around: Element, nodes: Iterable[str] = ()) -> Iterator[ParamFileDoc]:
        """Yield the YAML files that are loaded directly inside an element."""
        prefixes = tuple(f"{name}/" for name in nodes)
        for element in around.elements:
            written = element.attributes.get("file", "")
            if element.name != "rosparam" or not written or element.attributes.get("command", "load") != "load":
                continue
            pattern = re.compile(".*".join(re.escape(part) for part in _PIECE.split(written)) + r"\Z")
            files: dict[tuple[BaseCase, str], None] = {}
            names: dict[str, None] = {}
            for outcome, param in self.loaded:
                path = param.origin.span.file.path
                if pattern.search(path) and (not prefixes or param.name.startswith(prefixes)):
                    inside = self.find_inside(path)
                    files[(outcome.case, inside or self.words.show(path, dict(outcome.given)))] = None
                    names[self.show_name(param.name, prefixes)] = None
            values = vary(files, self.cases) if files else (Value(" ".join(written.split())),)
            yield ParamFileDoc(values, tuple(names))

    def describe_topics(self, specs: Sequence[tuple[ResolvedCase, NodeSpec]]) -> tuple[TopicDoc, ...]:
        """Describe the known topics, services and actions of a node, in any case."""
        found: dict[TopicDoc, None] = {}
        for outcome, node in specs:
            for use in find_name_uses(node):
                found[self.describe_topic(use, outcome)] = None
        return tuple(found)

    def describe_topic(self, use: NameUse, outcome: ResolvedCase) -> TopicDoc:
        """Describe one name that a node uses."""
        name = self.words.show(use.name.replace(HERE, ""), dict(outcome.given))
        rate = f"{use.rate:g} Hz" if use.rate is not None else ""
        return TopicDoc(_USES[use.use], name, use.evidence, rate)


def _first_per_case(
    found: Iterable[tuple[ResolvedCase, Resolution, NodeSpec]],
) -> list[tuple[ResolvedCase, Resolution, NodeSpec]]:
    first: dict[BaseCase, tuple[ResolvedCase, Resolution, NodeSpec]] = {}
    for each in found:
        first.setdefault(each[0].case, each)
    return list(first.values())


def _list_traits(element: Element, nodes: Sequence[NodeSpec]) -> Iterator[str]:
    if element.name == "test":
        yield "a test"
    if any(node.terminal for node in nodes):
        yield "owns the terminal"
    if any(node.required for node in nodes):
        yield "the run ends with it"
    if any(node.respawn for node in nodes):
        yield "is started again when it ends"


def _written_machine(element: Element) -> str:
    machine = element.attributes.get("machine", "")
    match = re.fullmatch(r"\$\(arg\s+(\w+)\)", machine)
    return match.group(1) if match else machine


def _show_plain(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, bytes):
        return f"{len(value)} bytes"
    return "" if value is None else str(value)
