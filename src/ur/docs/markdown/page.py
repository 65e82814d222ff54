"""The page as Markdown: how to run, programs, launch directories, bases, and a section for each launch file."""

import posixpath
import re
import shlex
from collections.abc import Iterable, Sequence
from typing import Literal

from ur.docs.documents import (
    ArgumentDoc,
    BaseCase,
    DirectoryDoc,
    Documents,
    IncludeDoc,
    LaunchDoc,
    NodeDoc,
    PackageDoc,
    ParamDoc,
    ParamFileDoc,
    ProgramDoc,
    TreeDoc,
    TreeItem,
    Value,
)
from ur.docs.words import map_links, name_cases
from ur.source.printable import printable, printable_lines

_REFERENCE = re.compile("\x00([^\x00]*)\x00")
_SLUG = re.compile(r"[^\w\- ]")
_CODE_OR_TAG = re.compile(r"(`{1,20})(?:(?!\1).){0,5000}\1|<|&(?!#?\w+;)", re.DOTALL)
_HEADING = re.compile(r"#{1,6}\s+(.*?)\s*#*\Z")


class MarkdownPage:
    """A page under construction. Links may precede their headings; a link without a heading becomes plain text."""

    def __init__(self, folder: str = "") -> None:
        """Start a page.

        `folder` is the prefix of paths to the root of the repository: empty, or with a slash at its end.
        """
        self._folder = folder
        self._lines: list[str] = []
        self._slugs: dict[str, int] = {}
        self._anchors: dict[str, str] = {}
        self._trees: dict[tuple[tuple[tuple[BaseCase, ...], int], ...], tuple[str, str]] = {}

    def note_trees(self, trees: tuple[TreeDoc, ...], title: str, key: str) -> tuple[str, str] | None:
        """Record where trees are shown; return title and key of the heading if they are already on the page."""
        identity = tuple((tree.cases, id(tree.root)) for tree in trees)
        known = self._trees.get(identity)
        self._trees.setdefault(identity, (title, key))
        return known

    def heading(self, level: int, title: str, key: str = "") -> None:
        """Add a heading, with a key for links to it."""
        title = printable(title)
        slug = _SLUG.sub("", title.lower()).replace(" ", "-")
        count = self._slugs.get(slug)
        self._slugs[slug] = 0 if count is None else count + 1
        if count is not None:
            slug = f"{slug}-{count + 1}"
            self._slugs.setdefault(slug, 0)
        if key:
            self._anchors[key] = slug
        self.line(f"{'#' * min(level, 6)} {escape_text(title)}")
        self.line()

    def line(self, text: str = "") -> None:
        """Add one line."""
        self._lines.append(text)

    def paragraph(self, text: str) -> None:
        """Add a separate paragraph."""
        self._lines += [text, ""]

    def markdown(self, text: str) -> None:
        """Add an author's Markdown: its headings become bold, so that they do not mix with those of the page."""
        fenced = False
        for line in map_links(text, self.place).splitlines():
            if line.lstrip().startswith("```"):
                fenced = not fenced
            heading = None if fenced else _HEADING.match(line)
            if heading:
                self.line(f"**{escape_text(heading.group(1))}**")
            else:
                self.line(line if fenced or line.startswith("    ") else escape_tags(line))
        if fenced:
            self.line("```")
        self.line()

    def table(self, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """Add a table; empty columns are left out."""
        used = [i for i in range(len(head)) if any(row[i] for row in rows)]
        self.line(f"| {' | '.join(head[i] for i in used)} |")
        self.line(f"|{'---|' * len(used)}")
        for row in rows:
            self.line(f"| {' | '.join(escape_cell(row[i]) for i in used)} |")
        self.line()

    def code_block(self, lines: Sequence[str], language: str) -> None:
        """Add lines of code."""
        self._lines += [f"```{language}", *map(printable, lines), "```", ""]

    def link_to(self, label: str, key: str) -> str:
        """Return a link to a heading of this page."""
        return f"\x00{key}\x01{label}\x00"

    def source_link(self, path: str, label: str = "") -> str:
        """Return a link to a file of the repository."""
        return f"[{escape_text(label or path)}]({self.place(path)})"

    def place(self, path: str) -> str:
        """Return the path of a file of the repository, relative to the page."""
        target = posixpath.normpath(self._folder + path) if self._folder else path
        return printable(target).replace(" ", "%20").replace("(", "%28").replace(")", "%29")

    def text(self) -> str:
        """Return the page."""

        def resolve(match: re.Match[str]) -> str:
            key, _, label = match.group(1).partition("\x01")
            slug = self._anchors.get(key)
            return f"[{escape_text(label)}](#{slug})" if slug is not None else code(label)

        return printable_lines(_REFERENCE.sub(resolve, "\n".join(self._lines)).rstrip("\n") + "\n")


def code(text: str) -> str:
    """Return a text as inline code."""
    text = " ".join(text.split())
    if not text:
        return ""
    fence = "`"
    while fence in text:
        fence += "`"
    space = " " if text.startswith("`") or text.endswith("`") else ""
    return f"{fence}{space}{text}{space}{fence}"


def inline(text: str) -> str:
    """Return Markdown of one line."""
    return escape_tags(" ".join(text.split()))


def escape_tags(text: str) -> str:
    """Return Markdown in which `<` outside of code is the character, not a tag."""
    if "<" not in text and "&" not in text:
        return text
    return _CODE_OR_TAG.sub(lambda m: {"<": "&lt;", "&": "&amp;"}.get(m.group(), m.group()), text)


def escape_text(text: str) -> str:
    """Escape a plain text so that Markdown shows it unchanged."""
    return re.sub(r"([\\`*\[\]<>|])|(?<![^\W_])(_)|(_)(?![^\W_])", lambda m: "\\" + m.group(), printable(text))


def escape_cell(text: str) -> str:
    """Escape a text for the cell of a table."""
    return re.sub(r"(?<!\\)\|", r"\\|", " ".join(text.split()))


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


Kind = Literal["node", "task", "view", "other"]
_KIND_TITLES: dict[Kind, str] = {
    "task": "Tasks: several nodes together",
    "node": "Single nodes",
    "view": "Viewers",
    "other": "Other folders",
}


def render_markdown(documents: Documents, folder: str = "") -> str:
    """Return `launches.md` for a file in `folder`, from which links lead to the root of the repository ("", "../")."""
    page = MarkdownPage(folder)
    single = len(documents.packages) == 1
    first = documents.packages[0]
    page.heading(1, first.name if single else documents.title)
    if single and first.description:
        page.paragraph(inline(first.description))
    page.paragraph(
        "*Made by `ur docs` from the launch files themselves; do not edit it. "
        "`ur docs --check` tells when it is out of date.*"
    )
    if not single:
        page.heading(2, "Packages")
        for package in documents.packages:
            about = f": {inline(package.description)}" if package.description else ""
            page.line(f"- {page.link_to(package.name, f'package {package.path}')}{about}")
        page.line()
    for package in documents.packages:
        if not single:
            page.heading(2, package.name, key=f"package {package.path}")
            if package.description:
                page.paragraph(inline(package.description))
        _write_package(page, package, 2 if single else 3)
    return page.text()


def _write_package(page: MarkdownPage, package: PackageDoc, level: int) -> None:
    by_path = {doc.path: doc for doc in package.launch_files}
    _write_how_to_run(page, package, level)
    if package.programs:
        page.heading(level, "Programs")
        rows = [(page.link_to(p.name, f"program {p.path}"), inline(p.summary)) for p in package.programs]
        page.table(("Program", "What it does"), rows)
        for program in package.programs:
            _write_program(page, program, by_path, level + 1)
    if package.launch_files:
        page.heading(level, "Launch directories")
        for kind, title in _KIND_TITLES.items():
            _write_directories(page, title, [each for each in package.directories if each.kind == kind])
    _write_bases(page, package, level)
    if package.launch_files:
        page.heading(level, "Launch files")
        names = [doc.name for doc in package.launch_files]
        for doc in package.launch_files:
            title = doc.name if names.count(doc.name) == 1 else doc.path
            write_launch_file(page, doc, title, level + 1)


def _write_how_to_run(page: MarkdownPage, package: PackageDoc, level: int) -> None:
    page.heading(level, "How to run")
    lines = []
    programs = [program for program in package.programs if program.starts] or list(package.programs)
    if programs:
        if programs[0].command.startswith("ur run"):
            lines += ["ur list  # the programs"]
        lines += [f"{programs[0].command}  # {programs[0].summary}".rstrip(" #")]
    doc = _choose_example(package.launch_files)
    if doc is not None:
        given = "".join(
            f" {arg.name}:={_example_value(arg.name, doc)}" for arg in doc.arguments if arg.kind == "required"
        )
        address = f"{package.name} {doc.name}" if package.is_package else shlex.quote(doc.path)
        option = "--ros-args" if doc.launcher == "roslaunch" else "--show-args"
        lines += [f"ur launch {address}{given}"] if doc.launcher == "roslaunch" else []
        lines += [f"{doc.launcher} {address}{given}", f"{doc.launcher} {option} {address}  # its arguments"]
    page.code_block(lines, "sh")


def _choose_example(docs: Sequence[LaunchDoc]) -> LaunchDoc | None:
    # Files that users start: no other file includes them, and they include most.
    whole = [doc for doc in docs if not doc.problems]
    return min(whole, key=lambda d: (bool(d.included_by), not d.started_by, -len(d.includes), d.path), default=None)


def _example_value(name: str, doc: LaunchDoc) -> str:
    if name == "robot_base":
        return next((each.case.base for each in doc.support if not each.missing), "BASE")
    return name.upper()


def _write_directories(page: MarkdownPage, title: str, directories: Sequence[DirectoryDoc]) -> None:
    if not directories:
        return
    rows = []
    for each in directories:
        links = ", ".join(page.link_to(path.rpartition("/")[2], f"launch {path}") for path in each.files)
        rows.append((code(each.path or "."), inline(each.summary) if each.summary else "", links))
    page.table((title, "What it is for", "Files"), rows)


def _write_bases(page: MarkdownPage, package: PackageDoc, level: int) -> None:
    if not package.bases:
        return
    page.heading(level, "Bases")
    rows = []
    for base in package.bases:
        variants = "; ".join(f"{code(name)} ({', '.join(has) or 'no sensors'})" for name, has in base.variants)
        rows.append((code(base.name), inline(base.summary), ", ".join(base.sensors), variants))
    page.table(("`robot_base`", "What it is", "It has", "`robot_variant`"), rows)


def _write_program(page: MarkdownPage, program: ProgramDoc, by_path: dict[str, LaunchDoc], level: int) -> None:
    page.heading(level, program.name, key=f"program {program.path}")
    if program.summary:
        page.paragraph(inline(program.summary))
    page.paragraph(f"{code(program.command)} — {page.source_link(program.path)}")
    if program.overview:
        page.markdown(program.overview)
    for path in program.starts:
        doc = by_path.get(path)
        works = [each.case for each in doc.support if not each.missing] if doc else []
        bases = f", which works on {escape_cell(name_cases(works))}" if works else ""
        page.paragraph(f"Starts {page.link_to(path.rpartition('/')[2], f'launch {path}')}{bases}.")
    write_trees(page, program.trees, program.name, f"program {program.path}")
