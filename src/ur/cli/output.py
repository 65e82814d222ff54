"""Output of untrusted texts: table cells without markup, exact bytes, files; and secrets and names that are given."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.source.printable import printable


def read_lines(descriptor: int | None, option: str, count: int, *, close: bool = True) -> list[str]:
    """Read the first lines of a file descriptor, '' for missing ones. Raises UserError.

    With `close` false it stays open: otherwise a file opened later may get number 0.
    """
    if descriptor is None:
        return [""] * count
    try:
        with open(descriptor, encoding="utf-8", closefd=close) as stream:
            return [*stream.read().split("\n"), *[""] * count][:count]
    except (OSError, UnicodeDecodeError) as problem:
        raise user_error(
            f"{option} {descriptor}: cannot be read: {problem}", rule="bad-descriptor", subject=option
        ) from None


def ask_twice(what: str) -> str:
    """Ask for a new password, without echo, until it is typed twice; '' for none."""
    import getpass

    while True:
        new = getpass.getpass(f"{what}: ")
        if new == "" or getpass.getpass("the same again: ") == new:
            return new
        sys.stdout.write("the two differ; once more\n")


def check_name(name: str) -> None:
    """Raise UserError if a name is not a valid robot name, or is that of this computer."""
    import socket

    from ur.robot.setup.robot_states import is_robot_name

    if not is_robot_name(name):
        raise user_error(
            f"{name!r} is not a valid host name, expected up to 63 lower-case letters, digits and -",
            rule="bad-name",
            subject=name,
        )
    if name in (socket.gethostname().split(".")[0], "localhost", "sim"):
        raise taken_error(name)


def taken_error(name: str) -> UserError:
    """Return the error about a name that another computer has."""
    return user_error(f"name {name!r} is taken, expected a name of its own for each computer", rule="taken-name")


if TYPE_CHECKING:
    from pathlib import Path

    from rich.text import Text


def plain_text(text: str, style: str = "") -> Text:
    """Return a cell of a rich table in which `[red]` is text, without control sequences for the terminal."""
    from rich.text import Text

    return Text(printable(text), style)


def write_exactly(text: str) -> None:
    """Write a text for another program, byte for byte; invalid UTF-8 is written as in its file."""
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode("utf-8", "surrogateescape"))
    sys.stdout.flush()


def replace_file(path: str | Path, text: str, doing: str = "written", **options: bool) -> None:
    """Replace the content of a file; its permissions stay. Raises UserError, with the file unchanged.

    `doing` completes the message "cannot be ..."; `options` are those of `ur.source.replace.replace_file`.
    """
    from ur.source.replace import replace_file as replace

    try:
        replace(path, text, **options)  # type: ignore[arg-type]  # one of them is a function
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error_about(path, f"cannot be {doing}: {reason}", rule="unwritable-file") from None
