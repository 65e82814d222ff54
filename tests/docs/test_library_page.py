"""The page of our own launch library: up to date, the same every time, its links alive."""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.docs.helpers import LIBRARY, ROOT, ROVER, document_folder, walk
from tests.docs.links import find_dead_markdown_links

from ur.docs.difference import show_difference
from ur.docs.markdown.page import render_markdown

PAGE = LIBRARY / "launches.md"

document = functools.cache(document_folder)


def test_page_is_what_the_launch_files_say() -> None:
    difference = show_difference(
        "ubiquity_launches/launches.md", PAGE.read_text("utf-8"), render_markdown(document(LIBRARY))
    )
    assert not difference, f"out of date; make it again with\n\n    ./ur docs ubiquity_launches\n\n{difference}"


@pytest.mark.parametrize("folder", [LIBRARY, ROVER], ids=lambda path: path.name)
def test_every_link_of_the_page_leads_somewhere(folder: Path) -> None:
    files = {str(path.relative_to(folder)) for path in folder.rglob("*")}
    assert find_dead_markdown_links(render_markdown(document(folder)), files) == []


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
