"""One launch file as a section of the page."""

from collections.abc import Iterable, Sequence

from ur.docs.documents import (
    ArgumentDoc,
    IncludeDoc,
    LaunchDoc,
    NodeDoc,
    ParamDoc,
    ParamFileDoc,
    TreeDoc,
    TreeItem,
    Value,
)
from ur.docs.markdown.text import MarkdownPage, code, inline
from ur.docs.vary import name_cases
from ur.graph.text import write_mermaid

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


def write_launch_file(page: MarkdownPage, doc: LaunchDoc, title: str, level: int) -> None:
    """Write the documentation of a launch file; empty parts are left out."""
    page.heading(level, title, key=f"launch {doc.path}")
    if doc.summary:
        page.paragraph(inline(doc.summary))
    page.paragraph(" — ".join(_list_places(page, doc)))
    for problem in doc.problems:
        page.paragraph(f"> **Broken:** {inline(problem)}")
    if doc.overview and " ".join(doc.overview.split()) != doc.summary:
        page.markdown(doc.overview)
    _write_support(page, doc)
    if doc.arguments:
        page.table(("Argument", "Type", "Default", "Meaning"), [_argument_row(each) for each in doc.arguments])
    if doc.nodes:
        page.table(("Node", "Program", "Machine", "When", "Notes"), [_node_row(each) for each in doc.nodes])
    if rows := list(_param_rows(page, doc)):
        page.table(("Parameters of", "Parameter", "Value"), rows)
    if rows := list(_topic_rows(doc)):
        page.table(("Names of", "", "Name", "Known from"), rows)
    if doc.includes:
        page.table(("Includes", "When", "Passes"), [_include_row(page, each) for each in doc.includes])
        write_trees(page, doc.trees, title, f"launch {doc.path}")
    if doc.graph.arrows:
        page.code_block(write_mermaid(doc.graph).splitlines(), "mermaid")


def _list_places(page: MarkdownPage, doc: LaunchDoc) -> Iterable[str]:
    yield page.source_link(doc.path)
    if doc.included_by:
        yield "included by " + ", ".join(
            page.link_to(path.rpartition("/")[2], f"launch {path}") for path in doc.included_by
        )
    if doc.started_by:
        yield "started by " + ", ".join(
            page.link_to(path.rpartition("/")[2], f"program {path}") for path in doc.started_by
        )


def _write_support(page: MarkdownPage, doc: LaunchDoc) -> None:
    if doc.needs:
        page.paragraph("Needs " + ", ".join(" or ".join(map(code, need.split("|"))) for need in doc.needs) + ".")
    works = [each.case for each in doc.support if not each.missing]
    if works:
        page.paragraph(f"Works on {inline(name_cases(works))}.")
    for each in doc.support:
        if each.missing:
            page.line(f"- Not on {inline(each.case.label)}: {inline('; '.join(each.missing))}")
    if len(works) < len(doc.support):
        page.line()


def _argument_row(argument: ArgumentDoc) -> tuple[str, ...]:
    default = {"required": "**required**", "optional": code(argument.default) or "(empty)"}.get(argument.kind)
    if default is None:
        default = f"always {code(argument.default) or '(empty)'}"
    condition = f" ({inline(argument.condition)})" if argument.condition else ""
    return (code(argument.name), argument.type, default + condition, inline(argument.doc))


def _node_row(node: NodeDoc) -> tuple[str, ...]:
    program = f"{_show_values(node.package)} {_show_values(node.type)}"
    return (
        _show_values(node.names),
        program,
        code(node.machine),
        inline(_when(node.conditions, node.only_with)),
        inline("; ".join(node.traits)),
    )


def _when(conditions: tuple[str, ...], only_with: str) -> str:
    if only_with:
        return f"only with {code(only_with)}"
    return " and ".join(conditions)


def _param_rows(page: MarkdownPage, doc: LaunchDoc) -> Iterable[tuple[str, ...]]:
    for node in doc.nodes:
        yield from _rows_of(page, node.names[0].text, node.params, node.param_files)
    yield from _rows_of(page, "", doc.params, doc.param_files)


def _rows_of(
    page: MarkdownPage, owner: str, params: Iterable[ParamDoc], files: Iterable[ParamFileDoc]
) -> Iterable[tuple[str, ...]]:
    shown = code(owner) if owner else "(all)"
    for file in files:
        count = f"{len(file.names)} parameters" if len(file.names) != 1 else code(file.names[0])
        yield (shown, count if file.names else "parameters", "from " + _show_values(file.files, page))
    for param in params:
        yield (shown, code(param.name), _show_values(param.values))


def _topic_rows(doc: LaunchDoc) -> Iterable[tuple[str, ...]]:
    sources = {
        "ready": "`ready:`",
        "comment": "a comment",
        "table": "the program's documentation",
        "base": "the base",
        "remap": "a remap",
    }
    for node in doc.nodes:
        groups: dict[tuple[str, str], list[str]] = {}
        for topic in node.topics:
            name = code(topic.name) + (f" at {topic.detail}" if topic.detail else "")
            groups.setdefault((topic.kind, topic.source), []).append(name)
        for (kind, source), names in groups.items():
            yield (code(node.names[0].text), kind, ", ".join(dict.fromkeys(names)), sources[source])
        if node.remaps:
            remaps = ", ".join(f"{code(old)} to {code(new)}" for old, new in node.remaps)
            yield (code(node.names[0].text), "remaps", remaps, "")


def _include_row(page: MarkdownPage, include: IncludeDoc) -> tuple[str, ...]:
    targets = []
    for target in include.targets:
        where = f" on {inline(name_cases(target.cases))}" if target.cases else ""
        if target.state in ("found", "candidate"):
            shown = page.link_to(target.name, f"launch {target.path}")
            targets.append(f"{shown}{where}" if target.state == "found" else f"perhaps {shown}")
        elif target.state == "missing":
            targets.append(f"{code(target.path)}{where}: **missing**")
        else:
            targets.append(f"{code(target.name)}{where}, elsewhere")
    passes = ", ".join(code(f"{name}:={value}") if value else code(name) for name, value in _shorten(include.passes))
    return ("; ".join(targets) or code(include.written), inline(_when(include.conditions, include.only_with)), passes)


def _shorten(passes: Iterable[tuple[str, str]]) -> Iterable[tuple[str, str]]:
    # Handing on an argument of the same name is the usual thing: its name is enough.
    for name, value in passes:
        yield (name, "") if value == f"$(arg {name})" else (name, value)


def _show_values(values: tuple[Value, ...], page: MarkdownPage | None = None) -> str:
    # With a page the values are files: those of the repository become links.
    shown = []
    for value in values:
        where = f" on {inline(name_cases(value.cases))}" if value.cases and value.cases[0].base else ""
        linked = page is not None and "$" not in value.text and not value.text.startswith("/")
        text = page.source_link(value.text) if linked and page else code(value.text) or "(empty)"
        shown.append(f"{text}{where}")
    return "; ".join(shown)
