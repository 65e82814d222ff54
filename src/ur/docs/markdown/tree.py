"""Trees as nested lists."""

from __future__ import annotations

from collections.abc import Sequence

from ur.docs.documents import TreeDoc, TreeItem
from ur.docs.markdown.text import MarkdownPage, code, inline
from ur.docs.vary import name_cases

MAX_LINES = 400


def write_trees(page: MarkdownPage, trees: Sequence[TreeDoc], title: str, key: str) -> None:
    """Write the started nodes by case; a repetition becomes a link to the first one."""
    first = page.note_trees(tuple(trees), title, key)
    if first is not None:
        page.paragraph(f"What it starts stands at {page.link_to(*first)}.")
        return
    for tree in trees:
        where = name_cases(tree.cases)
        page.paragraph(f"**On {where}**" if where else "**What it starts**")
        left = MAX_LINES
        for item in (tree.root, *([] if tree.root.children else [TreeItem("node", "nothing")])):
            left = _write_item(page, item, 0, left)
        if left <= 0:
            page.line("- ...")
        page.line()


def _write_item(page: MarkdownPage, item: TreeItem, depth: int, left: int) -> int:
    if left <= 0:
        return left
    off = "off by default: " if item.kind == "off" else ""
    note = f" — {off}{inline(item.note)}" if item.note else ""
    page.line(f"{'  ' * depth}- {_describe(page, item)}{note}")
    left -= 1
    for child in item.children:
        left = _write_item(page, child, depth + 1, left)
    return left


def _describe(page: MarkdownPage, item: TreeItem) -> str:
    if item.kind == "file":
        return page.link_to(item.name, f"launch {item.path}")
    if item.kind == "node":
        return f"{code(item.name)} ({item.detail})" if item.detail else item.name
    if item.kind == "off":
        name = item.name.rpartition("/")[2]
        return page.link_to(item.path.rpartition("/")[2], f"launch {item.path}") if item.path else code(name)
    if item.kind == "missing":
        return f"{code(item.name)}: **missing**"
    if item.kind == "cycle":
        return f"{code(item.name)}: **includes itself**"
    if item.kind == "elsewhere":
        return f"{code(item.name)}, which is not part of this repository"
    return f"{code(item.name)}, which depends on what is given"
