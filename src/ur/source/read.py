"""Text files of the user, read with an error that names the expected content."""

from pathlib import Path

from ur.source.diagnostic import user_error_about
from ur.source.file import SourceFile
from ur.source.foreign.files import MAX_BYTES, PIPES, read_file, read_pipe, refuse_file
from ur.source.suggest import did_you_mean


def read_source(
    path: str | Path, expected: str = "a readable text file", limit: int = MAX_BYTES, *, piped: bool = True
) -> SourceFile:
    """Read a file of at most `limit` bytes as UTF-8. Raises UserError, which names the path.

    A path that another file names is not `piped`: it is never read from standard input or a shell's `<(...)`.
    """
    name = str(path)
    try:
        data = read_pipe(name, limit) if piped and name.startswith(PIPES) else read_file(name, limit)
        return SourceFile(name, data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").decode("utf-8"))
    except UnicodeDecodeError as problem:
        raise user_error_about(
            path, f"byte {problem.start} is not UTF-8, expected {expected}", rule="unreadable-file"
        ) from None
    except OSError as problem:
        missing = isinstance(problem, FileNotFoundError)
        raise refuse_file(path, problem, expected, help=_suggest_sibling(Path(path)) if missing else None) from None


def _suggest_sibling(path: Path) -> str | None:
    try:
        names = [item.name for item in path.parent.iterdir() if item.suffix == path.suffix]
    except OSError:
        return f"there is no folder {path.parent}"
    near = did_you_mean(path.name, names)
    if near:
        return f"did you mean {path.with_name(near)}?"
    return f"there is {', '.join(sorted(names))}" if 0 < len(names) <= 12 else None
