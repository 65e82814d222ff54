"""The nodes of a launch file in every case, and the tree of files and nodes that it starts for each base."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from ur.check.rule import LaunchView
from ur.docs.cases.resolve import FileOutline, Resolution, ResolvedCase, find_node, list_switches
from ur.docs.cases.started import Item, StartedFile, find_taking_part, place_name, place_of
from ur.docs.documents import BaseCase, NodeDoc, ParamDoc, ParamFileDoc, TopicDoc, TreeDoc, TreeItem, TreeKind, Value
from ur.docs.repository.bases import match_paths
from ur.docs.repository.collect import is_elsewhere, is_unknown
from ur.docs.words import Words, vary
from ur.launchfile.plan.one_file import HERE
from ur.launchfile.plan.specs import NodeSpec, ParamSpec
from ur.launchfile.query.topics import find_name_uses
from ur.launchfile.syntax import Element

MAX_DEPTH = 40
_Resolutions = Sequence[
    tuple[str, StartedFile]
]  # the option that is changed, and what is started then; the default first


class TreeMaker:
    """Makes trees. `views`: the launch files by path; `outlines` returns their tags, `show_path` formats a path."""

    def __init__(
        self, views: Mapping[str, LaunchView], outlines: Callable[[str], FileOutline], show_path: Callable[[str], str]
    ) -> None:
        self._views = views
        self._outlines = outlines
        self._show_path = show_path
        self._items: dict[tuple[object, ...], TreeItem] = {}

    def make_trees(self, path: str, outcomes: Sequence[ResolvedCase], words: Words) -> tuple[TreeDoc, ...]:
        """Return the trees of a file: one for all cases in which it is the same."""
        groups: dict[int, tuple[TreeItem, list[BaseCase]]] = {}
        taking_part = find_taking_part(resolution.started for outcome in outcomes for resolution in outcome.resolutions)
        for outcome in outcomes:
            growing = _Growing(self, words, dict(outcome.given), taking_part)
            children = growing.grow(
                [(resolution.label, resolution.started) for resolution in outcome.resolutions], HERE, 0
            )
            root = self.intern("file", path.rpartition("/")[2], self._show_path(path), children=children)
            groups.setdefault(id(root), (root, []))[1].append(outcome.case)
        return tuple(TreeDoc(tuple(case for case in cases if case.base), root) for root, cases in groups.values())

    def intern(
        self,
        kind: TreeKind,
        name: str,
        path: str = "",
        detail: str = "",
        note: str = "",
        children: Sequence[TreeItem] = (),
    ) -> TreeItem:
        """Return an item; the same object for the same content."""
        key = (kind, name, path, detail, note, *map(id, children))
        item = self._items.get(key)
        if item is None:
            item = self._items[key] = TreeItem(kind, name, path, detail, note, tuple(children))
        return item

    def outline_of(self, path: str) -> FileOutline:
        """Return the tags of a file."""
        return self._outlines(path)

    def show_path(self, path: str) -> str:
        """Format a path."""
        return self._show_path(path)

    def targets_of(self, include: Element, written: str) -> list[str]:
        """Return the files that a path in an include may refer to, as displayed."""
        view = self._views.get(include.source.path)
        return [self._show_path(path) for path in match_paths(written, view)] if view is not None else []


class _Growing:
    # The tree of one file in one case.
    def __init__(
        self, maker: TreeMaker, words: Words, given: Mapping[str, str], taking_part: Mapping[str, set[int]]
    ) -> None:
        self.maker = maker
        self.taking_part = taking_part
        self.words = words
        self.given = given
        self.known: dict[tuple[object, ...], tuple[TreeItem, ...]] = {}

    def grow(self, resolutions: _Resolutions, namespace: str, depth: int) -> tuple[TreeItem, ...]:
        if len({id(started) for _, started in resolutions}) == 1:
            resolutions = resolutions[:1]  # nothing differs from here on
        key = (namespace, *((label, id(started)) for label, started in resolutions))
        if key not in self.known:
            self.known[key] = tuple(self.grow_once(resolutions, namespace, depth)) if depth < MAX_DEPTH else ()
        return self.known[key]

    def grow_once(self, resolutions: _Resolutions, namespace: str, depth: int) -> list[TreeItem]:
        places: dict[tuple[int, str], list[tuple[str, Item]]] = {}
        for label, started in resolutions:
            for item in started.items:
                places.setdefault(_place(item), []).append((label, item))
        usual = {_place(item) for item in resolutions[0][1].items}
        path = resolutions[0][1].path
        outline = self.maker.outline_of(path)
        made = []
        dormant = [] if "$" not in outline.text else self.list_dormant(path, outline)
        for place in sorted((*places, *dormant)):
            note = " and ".join(outline.conditions.get(place[0], ()))
            if place not in places:
                made.append(self.maker.intern("off", place[1], self.find_target(place, outline), "", note))
                continue
            if place not in usual:
                switches = " or ".join(dict.fromkeys(f"`{label}`" for label, _ in places[place] if label))
                note = f"only with {switches}" if switches else note
            made.append(self.grow_item(places[place], note, namespace, depth))
        return made

    def list_dormant(self, path: str, outline: FileOutline) -> list[tuple[int, str]]:
        # Conditional tags that are enabled in no case that was tried: listed as disabled.
        there = self.taking_part.get(path, set())
        found = []
        for element in (*outline.includes, *outline.nodes):
            if element.start not in there and element.start in outline.conditions:
                what = element.attributes.get("file" if element.name == "include" else "name", "")
                for name in ("robot_base", "robot_variant"):
                    what = what.replace(f"$(arg {name})", self.given.get(name, f"$(arg {name})"))
                found.append((element.start, " ".join(what.split())))
        return found

    def find_target(self, place: tuple[int, str], outline: FileOutline) -> str:
        include = next((each for each in outline.includes if each.start == place[0]), None)
        paths = self.maker.targets_of(include, place[1]) if include is not None else []
        return paths[0] if len(paths) == 1 else ""

    def grow_item(self, found: Sequence[tuple[str, Item]], note: str, namespace: str, depth: int) -> TreeItem:
        first = found[0][1]
        if isinstance(first, NodeSpec):
            name = self.show(place_name(first.full_name, namespace)) if first.name else "(no name)"
            return self.maker.intern("node", name, "", self.show(f"{first.package}/{first.type}"), note)
        include, child = first
        file = include.file
        if is_elsewhere(file):
            return self.maker.intern("elsewhere", self.show(file), note=note)
        if is_unknown(file):
            return self.maker.intern("unknown", self.show(file), note=note)
        path = self.maker.show_path(file)
        if child is None:
            return self.maker.intern("cycle" if include.found else "missing", path, path, note=note)
        inner = [(label, item[1]) for label, item in found if not isinstance(item, NodeSpec) and item[1] is not None]
        children = self.grow(inner, place_name(include.namespace, namespace), depth + 1)
        return self.maker.intern("file", file.rpartition("/")[2], path, "", note, children)

    def show(self, text: str) -> str:
        return self.words.show(text, self.given)


def _place(item: Item) -> tuple[int, str]:
    return (place_of(item), item.full_name if isinstance(item, NodeSpec) else item[0].file)


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
        machine = element.attributes.get("machine", "")
        match = re.fullmatch(r"\$\(arg\s+(\w+)\)", machine)
        return NodeDoc(
            names=self.vary_or_written(specs, "full_name", element.attributes.get("name", "")),
            package=self.vary_or_written(specs, "package", element.attributes.get("pkg", "")),
            type=self.vary_or_written(specs, "type", element.attributes.get("type", "")),
            machine=(match.group(1) if match else machine),
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
                # Describe one name that a node uses
                name = self.words.show(use.name.replace(HERE, ""), dict(outcome.given))
                rate = f"{use.rate:g} Hz" if use.rate is not None else ""
                found[TopicDoc(_USES[use.use], name, use.evidence, rate)] = None
        return tuple(found)


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


def _show_plain(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, bytes):
        return f"{len(value)} bytes"
    return "" if value is None else str(value)
