"""Replacement of a file, with errors that people understand."""

from __future__ import annotations

from ur.source.diagnostic import UserError, error
from ur.source.replace import replace_file as replace


def replace_file(path: str, text: str, doing: str = "written") -> None:
    """Give a file another content; its permissions stay. Raises UserError; then it is as it was.

    `doing` completes "cannot be ...".
    """
    try:
        replace(path, text)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error(f"{path}: cannot be {doing}: {reason}", rule="unwritable-file")) from None
