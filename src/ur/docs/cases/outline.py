"""The tags of a launch file that documents show, with their conditions."""

from collections.abc import Mapping
from dataclasses import dataclass

from ur.docs.words import describe_condition
from ur.launchfile.syntax import Element, LaunchFile


@dataclass(frozen=True, slots=True)
class FileOutline:
    """The tags `<node>`, `<test>` and `<include>` by position, and every tag's conditions, outermost first."""

    nodes: tuple[Element, ...]
    includes: tuple[Element, ...]
    groups: tuple[Element, ...]  # <launch> and every <group>: parameters may stand in them
    conditions: Mapping[int, tuple[str, ...]]
    raw_conditions: Mapping[int, tuple[str, ...]]  # as they are written
    text: str


def outline_file(tree: LaunchFile) -> FileOutline:
    """Find the tags of a file."""
    nodes: list[Element] = []
    includes: list[Element] = []
    groups: list[Element] = []
    conditions: dict[int, tuple[str, ...]] = {}
    raw: dict[int, tuple[str, ...]] = {}

    def visit(element: Element, above: tuple[str, ...], raw_above: tuple[str, ...]) -> None:
        groups.append(element)
        for child in element.elements:
            own = describe_condition(child)
            whole = (*above, own) if own else above
            raw_whole = raw_above
            if own:
                written = (child.attributes[word] for word in ("if", "unless") if word in child.attributes)
                raw_whole = (*raw_above, *written)
            if whole:
                conditions[child.start] = whole
                raw[child.start] = raw_whole
            if child.name in ("node", "test"):
                nodes.append(child)
            elif child.name == "include":
                includes.append(child)
            elif child.name == "group":
                visit(child, whole, raw_whole)

    if tree.launch is not None:
        visit(tree.launch, (), ())
    return FileOutline(tuple(nodes), tuple(includes), tuple(groups), conditions, raw, tree.source.text)
