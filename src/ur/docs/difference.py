"""Differences between the present and the desired content of files."""

import difflib

_MAX_LINES = 400


def show_difference(path: str, old: str | None, new: str) -> str:
    """Return a unified difference, empty for equal texts. `old` is None for a missing file."""
    if old == new:
        return ""
    lines = list(
        difflib.unified_diff(
            _lines(old or ""), _lines(new), path if old is not None else "/dev/null", f"{path} (made again)"
        )
    )
    if len(lines) > _MAX_LINES:
        lines = [*lines[:_MAX_LINES], f"... and {len(lines) - _MAX_LINES} more lines\n"]
    return "".join(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines)


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)
