"""Text with positions, and diagnostics about it. The bottom layer: it imports no other part of `ur`.

Public names are imported on first use: importing all of them would slow down completion.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:  # as typing's, whose import takes time
    from ur.source.diagnostic import Diagnostic, Note, Severity, UserError, error
    from ur.source.file import Position, SourceFile, Span
    from ur.source.render import render_human
    from ur.source.suggest import did_you_mean

_MODULES = {
    "diagnostic": ("Diagnostic", "Note", "Severity", "UserError", "error"),
    "file": ("Position", "SourceFile", "Span"),
    "render": ("render_human",),
    "suggest": ("did_you_mean",),
}

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


def __getattr__(name: str) -> object:
    from importlib import import_module

    for module, names in _MODULES.items():
        if name in names:
            return getattr(import_module(f"ur.source.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
