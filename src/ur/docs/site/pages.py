"""The pages of programs and launch files, and the index page."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from html import escape

from ur.docs.documents import BaseCase, Documents, LaunchDoc, PackageDoc, ProgramDoc, SupportDoc, TreeDoc, TreeItem
from ur.docs.markdown.page import KIND_TITLES, how_to_run
from ur.docs.site.html import blocks, cases_attribute, code, inline, link, section, table
from ur.docs.site.layout import SitePlan, render_page, way_between
from ur.docs.site.parts import Parts
from ur.docs.vary import name_cases
from ur.graph.boxes import DrawnGraph, GraphBox
from ur.graph.svg import draw_inline

_XML = re.compile(
    r"(?P<comment><!--.*?(?:-->|\Z))|(?P<tag></?[\w:.-]+|/?>|\?>|<\?[\w:.-]+)|(?P<value>\"[^\"]*\"|'[^']*')", re.DOTALL
)
_SHELL = re.compile(r"(?P<comment>(?:^|(?<=\s))#[^\n]*)|(?P<value>\"[^\"\n]*\"|'[^'\n]*')", re.MULTILINE)

_LONG = 46

_TREE_LINES = 1000


class Pages:
    """Renders the pages of a site."""

    def __init__(self, documents: Documents, plan: SitePlan) -> None:
        self.documents = documents
        self.plan = plan
        self.by_path = {doc.path: doc for package in documents.packages for doc in package.launch_files}

    def render_index(self) -> str:
        """Return the index page: commands, and all items with their summaries."""
        parts = [f"<h1>{escape(self.plan.title)}</h1>"]
        single = len(self.documents.packages) == 1
        toc: list[tuple[str, str]] = []
        for number, package in enumerate(self.documents.packages):
            prefix = "" if single else f"p{number}-"
            if not single:
                toc.append((f"{prefix}package", package.name))
                parts.append(f'<h2 class="package" id="{prefix}package">{escape(package.name)}</h2>')
            if package.description:
                parts.append(f'<p class="summary">{inline(package.description)}</p>')
            for anchor, title, content in self.list_package(package):
                toc += [(anchor, title)] if single else []
                parts.append(section(prefix + anchor, title, content))
        return render_page(self.plan, "index.html", self.plan.title, "".join(parts), toc=toc)

    def list_package(self, package: PackageDoc) -> list[tuple[str, str, str]]:
        """Return anchor, title and content of each part about a package."""
        lines = "\n".join(escape(line) for line in how_to_run(package))
        found = [("run", "How to run", f'<pre class="run" tabindex="0"><code>{lines}</code></pre>')]
        if package.programs:
            cards = [self.card(p.name, self.plan.program_pages[p.path], p.summary, ()) for p in package.programs]
            found.append(("programs", "Programs", f'<ul class="cards">{"".join(cards)}</ul>'))
        for kind, title in KIND_TITLES.items():
            files = [path for each in package.directories if each.kind == kind for path in each.files]
            if files:
                docs = [self.by_path[path] for path in files]
                cards = [
                    self.card(self.plan.labels[d.path], self.plan.launch_pages[d.path], d.summary, d.support)
                    for d in docs
                ]
                found.append((f"{kind}s", title, f'<ul class="cards">{"".join(cards)}</ul>'))
        if package.bases:
            found.append(("bases", "Bases", _bases_table(package)))
        return found

    def card(self, name: str, page: str, summary: str, support: Sequence[SupportDoc]) -> str:
        """Return a link with a summary; it is pale for a base that the file does not support."""
        lacking = " ".join(each.case.key for each in support if each.missing)
        attribute = f' data-not-on="{escape(lacking)}"' if lacking else ""
        text = f"<p>{inline(summary)}</p>" if summary else ""
        return f"<li{attribute}>{link(page, escape(name))}{text}</li>"

    def render_program(self, doc: ProgramDoc) -> str:
        """Return the page of a program."""
        page = self.plan.program_pages[doc.path]
        parts = [f"<h1>{escape(doc.name)}</h1>"]
        if doc.summary:
            parts.append(f'<p class="summary">{inline(doc.summary)}</p>')
        parts.append(f'<pre class="run" tabindex="0"><code>{escape(doc.command)}</code></pre>')
        sections: list[tuple[str, str, str]] = []
        if doc.overview:
            parts.append(f'<div class="prose">{blocks(doc.overview, lambda p: self.place(p, page))}</div>')
        for path in doc.starts:
            parts.append(f"<p>Starts {self.link_to(path, page)}.</p>")
            if path in self.by_path:
                parts.append(_support(self.by_path[path]))
        if doc.trees:
            sections.append(("tree", "What it starts", self.trees(doc.trees, page)))
        for path in doc.starts:
            if path in self.by_path and len(doc.starts) == 1:
                drawn = draw_svg(self.by_path[path].graph, f"Graph of {doc.name}", lambda p: self.place(p, page))
                sections.append(("graph", "Graph", f'<div class="canvas" tabindex="0">{drawn}</div>'))
        sections.append(("source", "Source", f"<p>{code(doc.path)}</p>{show_source(doc.source, xml=False)}"))
        cases = _cases_of(tree.cases for tree in doc.trees)
        return self.finish(page, doc.name, parts, sections, cases)

    def render_launch_file(self, doc: LaunchDoc) -> str:
        """Return the page of a launch file."""
        page = self.plan.launch_pages[doc.path]
        head = [f"<h1>{escape(self.plan.labels[doc.path])}</h1>"]
        if doc.summary:
            head.append(f'<p class="summary">{inline(doc.summary)}</p>')
        head += [f'<p class="problem" role="alert"><strong>Broken:</strong> {inline(p)}</p>' for p in doc.problems]
        for each in doc.support:
            if each.missing:
                text = f"Does not work on {escape(each.case.label)}: {inline('; '.join(each.missing))}."
                head.append(f'<p class="problem" data-only="{escape(each.case.key)}" hidden>{text}</p>')
        head.append(_support(doc))
        head.append(self.neighbours(doc, page))
        if doc.overview and " ".join(doc.overview.split()) != doc.summary:
            head.append(f'<div class="prose">{blocks(doc.overview, lambda p: self.place(p, page))}</div>')
        parts = Parts(doc, lambda path: self.place(path, page))
        sections = parts.sections()
        if doc.includes:
            sections.append(("tree", "What it starts", self.trees(doc.trees, page)))
        drawn = draw_svg(doc.graph, f"Graph of {doc.name}", lambda path: self.place(path, page))
        if drawn:
            sections.append(("graph", "Graph", f'<div class="canvas" tabindex="0">{drawn}</div>'))
        sections.append(("source", "Source", f"<p>{code(doc.path)}</p>{show_source(doc.source, xml=True)}"))
        cases = tuple(each.case for each in doc.support)
        return self.finish(page, self.plan.labels[doc.path], head, sections, cases)

    def finish(
        self,
        page: str,
        title: str,
        head: Sequence[str],
        sections: Sequence[tuple[str, str, str]],
        cases: Sequence[BaseCase],
    ) -> str:
        """Return a page of a head and sections."""
        content = "".join(head) + "".join(section(*each) for each in sections)
        toc = [(anchor, heading) for anchor, heading, _ in sections]
        return render_page(self.plan, page, title, content, cases, toc)

    def place(self, path: str, page: str) -> str | None:
        """Return the URL of a path of the repository, relative to a page; None for a path that is not on the site."""
        bare, hash_, _ = path.partition("#")
        target = self.plan.launch_pages.get(bare) or self.plan.program_pages.get(bare)
        return way_between(page, target) if target is not None and not hash_ else None

    def link_to(self, path: str, page: str) -> str:
        """Return a link to a launch file or program, with its name."""
        name = escape(self.plan.labels.get(path, path.rpartition("/")[2]))
        target = self.place(path, page)
        return link(target, name) if target else f"<code>{name}</code>"

    def neighbours(self, doc: LaunchDoc, page: str) -> str:
        """List the files that include a file and the programs that start it."""
        parts = []
        if doc.included_by:
            parts.append("Included by " + ", ".join(self.link_to(path, page) for path in doc.included_by) + ".")
        if doc.started_by:
            parts.append("Started by " + ", ".join(self.link_to(path, page) for path in doc.started_by) + ".")
        return f'<p class="neighbours">{" ".join(parts)}</p>' if parts else ""

    def trees(self, trees: Sequence[TreeDoc], page: str) -> str:
        """Return one tree per group of cases."""
        parts = []
        for tree in trees:
            names = name_cases(tree.cases)
            title = f"<h3>On {escape(names)}</h3>" if names else ""
            budget = [_TREE_LINES]
            items = self.tree_item(tree.root, page, budget)
            parts.append(f'<div{cases_attribute(tree.cases)}>{title}<ul class="tree">{items}</ul></div>')
        return "".join(parts)

    def tree_item(self, item: TreeItem, page: str, budget: list[int]) -> str:
        """Return an item of a tree with its children."""
        budget[0] -= 1
        if budget[0] < 0:
            return "<li>…</li>" if budget[0] == -1 else ""
        note = f' <span class="where">{_note(item)}</span>' if item.note else ""
        below = "".join(self.tree_item(child, page, budget) for child in item.children)
        inner = f"<ul>{below}</ul>" if below else ""
        return f'<li class="{item.kind}">{self.tree_label(item, page)}{note}{inner}</li>'

    def tree_label(self, item: TreeItem, page: str) -> str:
        """Return the label of an item."""
        if item.kind == "file" or (item.kind == "off" and item.path):
            return self.link_to(item.path, page)
        if item.kind == "node":
            detail = f' <span class="quiet">{escape(item.detail)}</span>' if item.detail else ""
            return code(item.name) + detail
        words = {
            "missing": "is missing",
            "cycle": "includes itself",
            "elsewhere": "is not part of this repository",
            "unknown": "depends on what is given",
            "off": "",
        }
        return f'{code(item.name)} <span class="quiet">{words[item.kind]}</span>'


def _note(item: TreeItem) -> str:
    return ("off by default: " if item.kind == "off" else "") + inline(item.note)


def _cases_of(groups: object) -> tuple[BaseCase, ...]:
    return tuple(dict.fromkeys(case for cases in groups for case in cases))  # type: ignore[attr-defined]  # iterables


def _support(doc: LaunchDoc) -> str:
    needs = " ".join(f"<code>{escape(' or '.join(need.split('|')))}</code>" for need in doc.needs)
    needed = f" It needs {needs}." if needs else ""
    if not doc.support:
        return f'<p class="support">{needed.strip()}</p>' if needed else ""
    chips = []
    for each in doc.support:
        why = f'<span class="why"> {inline("; ".join(each.missing))}</span>' if each.missing else ""
        kind, mark = ("no", "✗ not on") if each.missing else ("yes", "✓")
        chips.append(f'<li class="{kind}">{mark} {escape(each.case.label)}{why}</li>')
    return f'<div class="support"><ul class="chips" aria-label="Bases">{"".join(chips)}</ul>{needed}</div>'


def _bases_table(package: PackageDoc) -> str:
    rows = [
        (
            code(base.name),
            inline(base.summary),
            escape(", ".join(base.sensors)),
            "<br>".join(f"{code(name)} {escape(', '.join(has))}" for name, has in base.variants),
        )
        for base in package.bases
    ]
    return table(("robot_base", "What it is", "It has", "robot_variant"), rows, "Bases")


def draw_svg(graph: DrawnGraph, label: str, link_of: Callable[[str], str | None]) -> str:
    """Return the graph as an `<svg>`; empty for one without arrows. `link_of`: the page of a path, None for no link."""
    boxes = tuple(_link(box, link_of) for box in graph.boxes)
    # The label of an arrow is in the box that it leads to.
    arrows = tuple(replace(arrow, label="") for arrow in graph.arrows)
    return draw_inline(DrawnGraph(boxes, arrows), label)


def _link(box: GraphBox, link_of: Callable[[str], str | None]) -> GraphBox:
    link = link_of(box.title) if box.title and box.kind != "this" else None
    return replace(box, label=_cut(box.label), note=_cut(box.note), title=box.title or box.label, link=link or "")


def _cut(text: str) -> str:
    return text if len(text) <= _LONG else text[: _LONG - 1] + "…"


def show_source(text: str, *, xml: bool) -> str:
    """Return lines with anchors `L1`, `L2`, ...; comments, tags and values in colours."""
    painted = "".join(_paint(text.expandtabs(4), _XML if xml else _SHELL))
    lines = painted.removesuffix("\n").split("\n")
    body = "\n".join(f'<span class="line" id="L{n}">{_close(line)}</span>' for n, line in enumerate(lines, 1))
    return f'<pre class="source" tabindex="0" aria-label="source"><code>{body}</code></pre>'


def _paint(text: str, pattern: re.Pattern[str]) -> Iterator[str]:
    position = 0
    for match in pattern.finditer(text):
        yield escape(text[position : match.start()], quote=False)
        # A line is an element of its own, so a comment over several lines is one piece per line.
        pieces = match.group().split("\n")
        yield "\n".join(f'<i class="{match.lastgroup}">{escape(piece, quote=False)}</i>' for piece in pieces)
        position = match.end()
    yield escape(text[position:], quote=False)


def _close(line: str) -> str:
    return line.rstrip("\r") or " "
