"""The site as texts by file name: pages, style, script, and the search index."""

from __future__ import annotations

import json
from importlib.resources import files

from ur.docs.documents import Documents, LaunchDoc
from ur.docs.site.layout import plan_site
from ur.docs.site.pages import Pages
from ur.source.printable import printable_lines

MANIFEST = ".ur-docs"
_ASSETS = ("style.css", "site.js")


def render_site(documents: Documents) -> dict[str, str]:
    """Return every file of the site by its name; the manifest lists them, one per line."""
    plan = plan_site(documents)
    pages = Pages(documents, plan)
    site = {"index.html": pages.render_index()}
    entries: list[tuple[str, str, str, str, str]] = []
    for package in documents.packages:
        for program in package.programs:
            name = plan.program_pages[program.path]
            site[name] = pages.render_program(program)
            entries.append((program.name, name, "program", program.summary, ""))
        for doc in package.launch_files:
            name = plan.launch_pages[doc.path]
            site[name] = pages.render_launch_file(doc)
            entries.append((plan.labels[doc.path], name, "launch file", doc.summary, _words(doc)))
    site["search.js"] = _search_index(entries)
    for asset in _ASSETS:
        site[asset] = (files("ur.docs.site") / asset).read_text(encoding="utf-8")
    site[MANIFEST] = "".join(f"{name}\n" for name in sorted(site))
    return site


def read_manifest(text: str) -> list[str]:
    """Return the names in a manifest; names outside of the site are ignored."""
    return [name for name in text.splitlines() if name and not name.startswith("/") and ".." not in name.split("/")]


def _words(doc: LaunchDoc) -> str:
    # What the search finds a file by, besides its name and summary.
    words: dict[str, None] = {argument.name: None for argument in doc.arguments}
    for node in doc.nodes:
        words.update({value.text: None for value in (*node.names, *node.package, *node.type)})
        words.update({topic.name: None for topic in node.topics})
        words.update({param.name.lstrip("~"): None for param in node.params})
    words.update({target.name: None for include in doc.includes for target in include.targets})
    return " ".join(words)


def _search_index(entries: list[tuple[str, str, str, str, str]]) -> str:
    rows = ",\n".join(json.dumps(entry, ensure_ascii=False) for entry in entries)
    return printable_lines("window.UR_SEARCH = [\n" + rows.replace("</", "<\\/") + "\n];\n")
