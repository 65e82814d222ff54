"""The page of our own launch library: up to date, the same every time, its links alive."""

import functools
import os
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest
from tests.docs.helpers import LIBRARY, ROOT, ROVER, document_folder, walk

from ur.cli.files.docs import show_difference
from ur.docs.markdown.page import render_markdown

PAGE = LIBRARY / "launches.md"
_MARKDOWN_LINK = re.compile(r"(?<!!)\[(?:[^\]\\]|\\.)*\]\(([^)\s]+)\)")
_CODE = re.compile(r"(`+).*?\1")
_HEADING = re.compile(r"#{1,6} (.*)")

document = functools.cache(document_folder)


def find_dead_links(text: str, files: set[str]) -> list[str]:
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


def test_page_is_what_the_launch_files_say() -> None:
    difference = show_difference(
        "ubiquity_launches/launches.md", PAGE.read_text("utf-8"), render_markdown(document(LIBRARY))
    )
    assert not difference, f"out of date; make it again with\n\n    ./ur docs ubiquity_launches\n\n{difference}"


@pytest.mark.parametrize("folder", [LIBRARY, ROVER], ids=lambda path: path.name)
def test_every_link_of_the_page_leads_somewhere(folder: Path) -> None:
    files = {str(path.relative_to(folder)) for path in folder.rglob("*")}
    assert find_dead_links(render_markdown(document(folder)), files) == []


def test_page_is_the_same_whatever_the_computer(tmp_path: Path) -> None:
    # Other packages, other variables, another order of sets.
    (tmp_path / "rviz").mkdir()
    (tmp_path / "rviz" / "package.xml").write_text("<package><name>rviz</name></package>")
    pages = []
    for seed, extra in (("1", {}), ("2", {"ROS_PACKAGE_PATH": str(tmp_path), "ROS_NAMESPACE": "/else", "HOME": "/x"})):
        done = subprocess.run(
            [sys.executable, "-m", "ur", "docs", str(LIBRARY), "--output", "-"],
            capture_output=True,
            timeout=100,
            check=True,
            cwd=tmp_path,
            env={"PATH": os.environ["PATH"], "PYTHONPATH": str(ROOT / "src"), "PYTHONHASHSEED": seed, **extra},
        )
        pages.append(done.stdout)
    assert pages[0] == pages[1]
    assert str(ROOT).encode() not in pages[0]


def test_every_launch_file_and_program_is_in_it() -> None:
    (package,) = document(LIBRARY).packages
    files = {str(path.relative_to(LIBRARY)) for path in LIBRARY.rglob("*.launch*")}
    assert {doc.path for doc in package.launch_files} == files
    programs = {path.name for path in (LIBRARY / "bin").glob("ur_*")}
    assert {program.name for program in package.programs} == programs
    for program in package.programs:
        assert program.summary, program.name
        assert program.overview, program.name
        assert program.trees, program.name
        assert program.command == f"ur run {program.name.removeprefix('ur_')}"


def test_everything_in_the_library_can_be_turned_on_by_something() -> None:
    # What the documents call "off by default" in every file would be dead.
    (package,) = document(LIBRARY).packages
    for doc in package.launch_files:
        for tree in doc.trees:
            hidden = [child.name for child in tree.root.children if child.kind == "off"]
            assert not hidden, (doc.path, hidden)
            assert all(item.kind not in ("missing", "cycle") for item in walk(tree.root)), doc.path
