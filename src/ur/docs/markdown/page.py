"""The page as a whole: how to run, programs, launch directories, bases, launch files."""

import shlex
from collections.abc import Sequence
from typing import Literal

from ur.docs.documents import DirectoryDoc, Documents, LaunchDoc, PackageDoc, ProgramDoc
from ur.docs.markdown.launch import write_launch_file, write_trees
from ur.docs.markdown.text import MarkdownPage, code, escape_cell, inline
from ur.docs.vary import name_cases

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
