"""Settings of Sphinx for the manual's site: `sphinx-build -W -c docs . .cache/site`, see CONTRIBUTING.md.

The sources are the Markdown pages of the tree as they are; the lists of docs/README.md become the navigation.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

project = "ubiquity_launches"
html_title = project
html_theme = "furo"
html_show_copyright = False
html_copy_source = False
extensions = ["myst_parser", "sphinxcontrib.mermaid"]
root_doc = "docs/README"
include_patterns = [
    "docs/**.md", "*.md", "src/**/README.md", "bench/**/README.md", "editors/README.md", "ubiquity_launches/*.md"
]  # fmt: skip
exclude_patterns = [".*", "**/node_modules"]
myst_heading_anchors = 4
myst_fence_as_directive = ["mermaid"]
mermaid_output_format = "raw"
suppress_warnings = ["toc.not_included", "misc.highlighting_failure", "myst.header"]

_PART = re.compile(r"^- \*\*(.+?)\*\*:(.*?)(?=^- |\Z)", re.MULTILINE | re.DOTALL)
_PAGE = re.compile(r"\]\(([^)#:]+)\.md\)")
_TREE = "\n```{{toctree}}\n:hidden:\n:caption: {}\n\n{}\n```\n"


def add_navigation(_app: Sphinx, page: str, source: list[str]) -> None:
    """Add to the index the pages that each of its lists names, and to that of rules all of them."""
    if page == root_doc:
        source[0] += "".join(
            _TREE.format(name, "\n".join(_PAGE.findall(part))) for name, part in _PART.findall(source[0])
        )
    elif page.endswith("rules/index"):
        source[0] += _TREE.format("rules", "\n".join(_PAGE.findall(source[0])))


def write_start_page(app: Sphinx, failure: Exception | None) -> None:
    """Lead from the site's root to the index."""
    if failure is None:
        start = f'<!doctype html><meta http-equiv="refresh" content="0; url={root_doc}.html"><title>{project}</title>\n'
        Path(app.outdir, "index.html").write_text(start, encoding="utf-8")


def setup(app: Sphinx) -> None:
    """Connect both."""
    app.connect("source-read", add_navigation)
    app.connect("build-finished", write_start_page)
