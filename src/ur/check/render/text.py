"""Reports as text, for display."""

from __future__ import annotations

from dataclasses import replace
from textwrap import fill

from ur.check.findings.installed import NotInstalled, split_not_installed
from ur.check.run import CheckReport
from ur.launchfile.syntax.parse import describe_unread
from ur.source.diagnostic import Diagnostic, Note
from ur.source.file import SourceFile, Span
from ur.source.printable import printable
from ur.source.render import render_human

_WIDTH = 100
_INSTALL = "'ur get --missing FOLDER' gets them; of packages built here: source their setup.bash"


def render_text(report: CheckReport, *, colour: bool = False) -> str:
    """Return the findings, one paragraph about packages that are not installed, and one line with counts."""
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


def summarise(report: CheckReport, *, nothing: str = "nothing found") -> str:
    """Return `2 errors and 1 warning in 40 files`; `nothing` if there is no finding."""
    warnings = len(report.findings) - report.errors
    counts = [_count(number, word) for number, word in ((report.errors, "error"), (warnings, "warning")) if number]
    hidden = f" ({_count(report.suppressed, 'finding')} hidden by comments)" if report.suppressed else ""
    left_out = f"; {skipped}" if (skipped := describe_unread(report.not_read)) else ""
    if not report.files:
        return f"nothing was checked: no launch file, YAML file or program of a package is there{left_out}"
    return f"{' and '.join(counts) or nothing} in {_count(report.files, 'file')}{hidden}{left_out}"


def _count(number: int, word: str) -> str:
    return f"{number} {word}{'' if number == 1 else 's'}"


def shorten_paths(report: CheckReport, folder: str) -> CheckReport:
    """Return the same report with paths relative to a folder, if they are below it."""
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
