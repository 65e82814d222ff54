"""Text with positions, and what tools have to say about it. The bottom layer: imports nothing of ours."""

from ur.source.diagnostic import Diagnostic, Note, Severity, UserError, error
from ur.source.file import Position, SourceFile, Span
from ur.source.render import render_human
from ur.source.suggest import did_you_mean

__all__ = [
    "Diagnostic",
    "Note",
    "Position",
    "Severity",
    "SourceFile",
    "Span",
    "UserError",
    "did_you_mean",
    "error",
    "render_human",
]
