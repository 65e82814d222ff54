"""Writing a file as a whole or not at all."""

from __future__ import annotations

from pathlib import Path

from ur.source.diagnostic import UserError, error


def replace_file(path: str, text: str, doing: str = "written") -> None:
    """Give a file another content; its permissions stay. Raises UserError; then it is as it was.

    `doing` completes "cannot be ...".
    """
    target = Path(path).resolve()  # a link stays a link
    beside = target.with_name(f".{target.name}.ur-new")
    try:
        beside.write_bytes(text.encode())
        beside.chmod(target.stat().st_mode & 0o7777)
        beside.replace(target)
    except OSError as problem:
        beside.unlink(missing_ok=True)
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error(f"{path}: cannot be {doing}: {reason}", rule="unwritable-file")) from None
