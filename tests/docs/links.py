"""A link checker for generated pages: every link and source leads to a file, every fragment to an anchor."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Mapping
from html.parser import HTMLParser
from urllib.parse import unquote

_MARKDOWN_LINK = re.compile(r"(?<!!)\[(?:[^\]\\]|\\.)*\]\(([^)\s]+)\)")
_CODE = re.compile(r"(`+).*?\1")
_HEADING = re.compile(r"#{1,6} (.*)")


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.repeated: list[str] = []
        self.links: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:  # noqa: ARG002 - HTMLParser's
        for name, value in attrs:
            if name == "id" and value:
                if value in self.anchors:
                    self.repeated.append(value)
                self.anchors.add(value)
            elif name in ("href", "src") and value:
                self.links.append(value)
            elif name in ("aria-controls", "aria-labelledby", "for") and value:
                self.links.append(f"#{value}")


def find_dead_links(site: Mapping[str, str]) -> list[str]:
    """What is wrong with the links of a site, given as texts by name: `page: link`."""
    pages: dict[str, _Page] = {}
    for name, text in site.items():
        if name.endswith(".html"):
            pages[name] = _Page()
            pages[name].feed(text)
    wrong = [f"{name}: id {each} twice" for name, page in pages.items() for each in page.repeated]
    for name, page in pages.items():
        for link in page.links:
            if link.startswith(("data:", "http://", "https://", "mailto:")):
                continue
            path, _, fragment = link.partition("#")
            target = posixpath.normpath(posixpath.join(posixpath.dirname(name), unquote(path))) if path else name
            if target not in site or (fragment and target in pages and unquote(fragment) not in pages[target].anchors):
                wrong.append(f"{name}: {link}")
    return wrong


def find_dead_markdown_links(text: str, files: set[str]) -> list[str]:
    """The links of a Markdown page that lead neither to a heading, named as GitHub names it, nor to a file."""
    anchors: dict[str, int] = {}
    slugs: set[str] = set()
    prose: list[str] = []
    fenced = False
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
        if fenced:
            continue
        heading = _HEADING.match(line)
        if heading:
            plain = heading.group(1).replace("\\", "")
            slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
            number = anchors.get(slug, 0)
            anchors[slug] = number + 1
            slugs.add(f"{slug}-{number}" if number else slug)
        prose.append(_CODE.sub("", line))
    found = _MARKDOWN_LINK.findall("\n".join(prose))
    return [
        link
        for link in found
        if "://" not in link and (link[1:] not in slugs if link.startswith("#") else unquote(link) not in files)
    ]
