"""Markdown that GitHub and other renderers show equally: headings with known anchors, tables, code."""

import posixpath
import re
from collections.abc import Sequence

from ur.docs.documents import BaseCase, TreeDoc
from ur.docs.words import map_links
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
