"""The common parts of all pages of the site: head, header with search and base switch, navigation, footer."""

from __future__ import annotations

import posixpath
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

from ur.docs.documents import BaseCase, Documents, PackageDoc
from ur.docs.markdown.page import KIND_TITLES
from ur.docs.site.html import link
from ur.source.printable import printable_lines

MAX_NAVIGATION = 120
_UNSAFE = re.compile(r"[^A-Za-z0-9._-]+")

_EARLY = """try{var t=localStorage.getItem("ur-theme");if(t)document.documentElement.dataset.theme=t}catch(e){}
document.documentElement.classList.add("js")"""


@dataclass(frozen=True, slots=True)
class SitePlan:
    """The pages of launch files and programs, by path in the repository, and all cases."""

    title: str
    launch_pages: Mapping[str, str]
    labels: Mapping[str, str]  # of launch files: the name where only one has it, else the path
    program_pages: Mapping[str, str]
    cases: tuple[BaseCase, ...]
    navigation: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]  # title, and (label, page) below it


def plan_site(documents: Documents) -> SitePlan:
    """Decide on the pages."""
    taken: set[str] = set()
    launch_pages = {
        doc.path: _page_name("launch", doc.path.replace("/launch/", "/"), taken)
        for package in documents.packages
        for doc in package.launch_files
    }
    program_pages = {
        doc.path: _page_name("program", doc.path, taken) for package in documents.packages for doc in package.programs
    }
    docs = [doc for package in documents.packages for doc in package.launch_files]
    names = Counter(doc.name for doc in docs)
    labels = {doc.path: doc.name if names[doc.name] == 1 else doc.path for doc in docs}
    cases = dict.fromkeys(
        each.case for package in documents.packages for doc in package.launch_files for each in doc.support
    )
    navigation: list[tuple[str, tuple[tuple[str, str], ...]]] = []
    for package in documents.packages:
        prefix = f"{package.name}: " if len(documents.packages) > 1 else ""
        navigation += [(prefix + title, entries) for title, entries in _navigate(package, launch_pages, program_pages)]
    if sum(len(entries) for _, entries in navigation) > MAX_NAVIGATION:
        navigation = []
    title = documents.packages[0].name if len(documents.packages) == 1 else documents.title
    return SitePlan(title, launch_pages, labels, program_pages, tuple(cases), tuple(navigation))


def _page_name(folder: str, path: str, taken: set[str]) -> str:
    stem = _UNSAFE.sub("-", path.removesuffix(".xml").removesuffix(".launch").strip("./")) or "page"
    stem = stem.removeprefix("bin-").removeprefix("launch-")
    parts = stem.split("-")
    if len(parts) > 1 and parts[-1] == parts[-2]:
        stem = "-".join(parts[:-1])  # n_amcl/n_amcl.launch.xml
    name, number = f"{folder}/{stem}.html", 2
    while name.lower() in taken:  # also where upper and lower case are the same
        name, number = f"{folder}/{stem}-{number}.html", number + 1
    taken.add(name.lower())
    return name


def _navigate(
    package: PackageDoc, launch_pages: Mapping[str, str], program_pages: Mapping[str, str]
) -> Sequence[tuple[str, tuple[tuple[str, str], ...]]]:
    groups = []
    if package.programs:
        groups.append(("Programs", tuple((each.name, program_pages[each.path]) for each in package.programs)))
    for kind, title in KIND_TITLES.items():
        files = [path for each in package.directories if each.kind == kind for path in each.files]
        if files:
            short = title.partition(":")[0]
            groups.append((short, tuple((_short(path), launch_pages[path]) for path in files)))
    return groups


def _short(path: str) -> str:
    return path.rpartition("/")[2].removesuffix(".xml").removesuffix(".launch")


def render_page(
    plan: SitePlan,
    name: str,
    title: str,
    content: str,
    cases: Sequence[BaseCase] = (),
    toc: Sequence[tuple[str, str]] = (),
) -> str:
    """Return a whole page. `cases` are those of its file; `toc` are anchors and titles of its parts."""
    up = "../" * name.count("/")
    own = " ".join(case.key for case in cases if case.base)
    whole = title if title == plan.title else f"{title} · {plan.title}"
    page = f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="ur docs">
<title>{escape(whole)}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="{up}style.css">
<script>{_EARLY}</script>
</head>
<body data-up="{up}" data-cases-here="{escape(own)}">
<a class="skip" href="#content">Skip to the content</a>
<header class="top">
<button type="button" id="menu" aria-label="Menu" aria-expanded="false" aria-controls="nav">☰</button>
<a class="home" href="{up}index.html">{escape(plan.title)}</a>
<div class="search" role="search">
<label class="hidden" for="search">Search launch files, programs, arguments, nodes and topics</label>
<input id="search" type="search" placeholder="Search   /" autocomplete="off" spellcheck="false" role="combobox"
 aria-expanded="false" aria-controls="results" aria-autocomplete="list" aria-keyshortcuts="/">
<ul id="results" role="listbox" aria-label="Results" hidden></ul>
<p id="found" class="hidden" role="status"></p>
</div>
{_switch(plan)}
<button type="button" id="theme" aria-label="Colours: as the computer">◐</button>
</header>
<div class="columns">
<nav id="nav" aria-label="Everything">{_navigation(plan, name, up)}</nav>
<main id="content" tabindex="-1">
{content}
</main>
{_toc(toc)}
</div>
<footer>Made by <code>ur docs</code> from the launch files themselves.
Keys: <kbd>/</kbd> search, <kbd>↑</kbd> <kbd>↓</kbd> choose, <kbd>Enter</kbd> open, <kbd>Esc</kbd> close.</footer>
<script src="{up}search.js"></script>
<script src="{up}site.js"></script>
</body>
</html>
"""
    return printable_lines(page)


def _switch(plan: SitePlan) -> str:
    if not plan.cases:
        return ""
    options = "".join(f'<option value="{escape(case.key)}">{escape(case.label)}</option>' for case in plan.cases)
    return (
        '<label class="base" for="base"><span class="word">Base</span> '
        '<select id="base" aria-label="Base" autocomplete="off">'
        f'<option value="">all</option>{options}</select></label>'
    )


def _navigation(plan: SitePlan, name: str, up: str) -> str:
    if not plan.navigation:
        return f"<p>{link(f'{up}index.html', 'All programs and launch files')}</p>"
    parts = []
    for title, entries in plan.navigation:
        items = "".join(f"<li>{link(up + page, escape(label), _current(page == name))}</li>" for label, page in entries)
        parts.append(f"<h2>{escape(title)}</h2><ul>{items}</ul>")
    return "".join(parts)


def _current(here: bool) -> str:
    return ' aria-current="page"' if here else ""


def _toc(toc: Sequence[tuple[str, str]]) -> str:
    if len(toc) < 2:
        return ""
    items = "".join(f"<li>{link('#' + anchor, escape(title))}</li>" for anchor, title in toc)
    return f'<aside class="toc" aria-label="On this page"><h2>On this page</h2><ul>{items}</ul></aside>'


def way_between(page: str, other: str) -> str:
    """Return a relative link from one page of the site to another."""
    return posixpath.relpath(other, posixpath.dirname(page) or ".")
