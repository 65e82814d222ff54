"""The tree of launch files and nodes that a launch file starts, per base; equal trees are one object."""

from collections.abc import Callable, Mapping, Sequence

from ur.check.rule import LaunchView
from ur.docs.cases.outline import FileOutline
from ur.docs.cases.resolve import ResolvedCase
from ur.docs.cases.started import Item, StartedFile, find_taking_part, place_name, place_of
from ur.docs.documents import BaseCase, TreeDoc, TreeItem, TreeKind
from ur.docs.repository.bases import match_paths
from ur.docs.repository.world import is_elsewhere, is_unknown
from ur.docs.words import Words
from ur.launchfile.plan.one_file import HERE
from ur.launchfile.plan.specs import NodeSpec
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
        inner = [(label, item[1]) for label, item in found if isinstance(item, tuple) and item[1] is not None]
        children = self.grow(inner, place_name(include.namespace, namespace), depth + 1)
        return self.maker.intern("file", file.rpartition("/")[2], path, "", note, children)

    def show(self, text: str) -> str:
        return self.words.show(text, self.given)


def _place(item: Item) -> tuple[int, str]:
    return (place_of(item), item.full_name if isinstance(item, NodeSpec) else item[0].file)
