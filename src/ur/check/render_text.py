"""A report, and a rule, for people."""

from __future__ import annotations

from dataclasses import replace
from textwrap import fill

from ur.check.examples import check_example, strip_marks
from ur.check.installed import NotInstalled, split_not_installed
from ur.check.model import Example, Rule
from ur.check.run import Report
from ur.source.diagnostic import Diagnostic, Note
from ur.source.file import SourceFile, Span
from ur.source.printable import printable
from ur.source.render import render_human

_WIDTH = 100
_INSTALL = "source the setup.bash of their workspace, or run 'rosdep install --from-paths . --ignore-src'"


def render_text(report: Report, *, colour: bool = False) -> str:
    """The findings, one paragraph about packages that are not installed, and one line that counts."""
    findings, not_installed = split_not_installed(report.findings)
    nothing = "nothing else found" if not_installed.packages else "nothing found"
    text = render_human(findings, colour=colour) + _describe_not_installed(not_installed)
    return text + summarise(replace(report, findings=findings), nothing=nothing) + "\n"


def _describe_not_installed(missing: NotInstalled) -> str:
    if not missing.packages:
        return ""
    subject = "1 package is" if len(missing.packages) == 1 else f"{len(missing.packages)} packages are"
    users = f"{_count(missing.files, 'file')} {'takes' if missing.files == 1 else 'take'}"
    names = printable(", ".join(missing.packages))
    text = f"{subject} not installed or not built here; what {users} from there is not checked: {names}"
    return fill(text, _WIDTH, subsequent_indent="  ", break_on_hyphens=False) + f"\n  help: {_INSTALL}\n"


def summarise(report: Report, *, nothing: str = "nothing found") -> str:
    """`2 errors and 1 warning in 40 files`; `nothing` is for no finding."""
    warnings = len(report.findings) - report.errors
    counts = [_count(number, word) for number, word in ((report.errors, "error"), (warnings, "warning")) if number]
    hidden = f" ({_count(report.suppressed, 'finding')} hidden by comments)" if report.suppressed else ""
    return f"{' and '.join(counts) or nothing} in {_count(report.files, 'file')}{hidden}"


def _count(number: int, word: str) -> str:
    return f"{number} {word}" + ("" if number == 1 else "s")


def shorten_paths(report: Report, folder: str) -> Report:
    """The same report with the paths of its places relative to a folder, where they lie in it."""
    files: dict[int, SourceFile] = {}
    prefix = folder.rstrip("/") + "/"

    def move(span: Span | None) -> Span | None:
        if span is None or not span.file.path.startswith(prefix):
            return span
        file = files.setdefault(id(span.file), SourceFile(span.file.path.removeprefix(prefix), span.file.text))
        return Span(file, span.start, span.end)

    def moved(found: Diagnostic) -> Diagnostic:
        notes = tuple(Note(note.message.replace(prefix, ""), move(note.span)) for note in found.notes)
        help_ = found.help.replace(prefix, "") if found.help else None
        message = found.message.replace(prefix, "")
        return replace(found, span=move(found.span), notes=notes, message=message, help=help_)

    return replace(report, findings=tuple(moved(found) for found in report.findings))


def render_rule_page(rule: Rule) -> str:
    """A rule as a page in Markdown, made from its own examples."""
    kinds = [f"group `{rule.group.value}`", rule.severity.value]
    if rule.house:
        kinds.append("only for packages that follow the house layout")
    if rule.fix is not None:
        kinds.append("repaired by `--fix`, where that is safe")
    parts = [f"# {rule.id}\n", f"{rule.summary}\n", f"*{', '.join(kinds)}*\n", f"{rule.explanation.strip()}\n"]
    for heading, examples in (("Not like this", rule.bad), ("But like this", rule.good)):
        if not examples:
            continue
        parts.append(f"## {heading}\n")
        for example in examples:
            parts.append(_show_files(example))
            if example in rule.bad:
                found = shorten_paths(check_example(example), "/ws/my_robot").findings
                parts.append(f"```text\n{render_human(found)}```\n")
    parts.append("## To hide it\n")
    parts.append(f"Put `{hide_comment(rule)}` before the place, with your reason; see [the index](index.md).\n")
    return "\n".join(parts)


def hide_comment(rule: Rule) -> str:
    """The comment that hides a rule's findings, in the language that most of its examples are in."""
    in_xml = not rule.bad or any(path.endswith((".launch", ".xml")) for path in rule.bad[0].files)
    words = f"ur: ignore {rule.id}: why it is meant to be so"
    return f"<!--{words}-->" if in_xml else f"# {words}"


def _show_files(example: Example) -> str:
    kinds = {"launch": "xml", "xml": "xml", "yaml": "yaml", "py": "python", "txt": "cmake"}
    parts = []
    for path, text in example.files.items():
        kind = kinds.get(path.rpartition(".")[2], "bash")
        parts.append(f"`{path}`\n\n```{kind}\n{strip_marks(text).strip()}\n```\n")
    return "\n".join(parts)


def render_index_page(rules: dict[str, Rule]) -> str:
    """The list of all rules as a page in Markdown."""
    lines = [
        "# Rules of `ur check`",
        "",
        "Mistakes are errors, conventions are warnings. `--select` and `--ignore` take ids and groups.",
        "",
        "A comment hides findings where they are meant to be so, and says why: `<!--ur: ignore RULE: REASON-->` in the",
        "element that follows, `<!--ur: ignore-file RULE: REASON-->` in the whole file; in YAML and programs",
        "`# ur: ignore RULE: REASON`, at the end of a line or alone above it.",
        "",
        "| rule | group | | finds |",
        "|---|---|---|---|",
    ]
    for rule in rules.values():
        marks = rule.severity.value + (", house" if rule.house else "") + (", `--fix`" if rule.fix else "")
        lines.append(
            f"| [{rule.id}]({rule.id}.md) | {rule.group.value} | {marks} | {rule.summary.replace('<', '&lt;')} |"
        )
    return "\n".join(lines) + "\n"
