"""Make docs/reference/verbs.md from the help of every verb. A test compares what is committed with this."""

from __future__ import annotations

import re
from collections.abc import Iterator
from inspect import cleandoc
from pathlib import Path

import click

from ur.cli.launch.options import list_groups
from ur.cli.verbs import VERBS, list_pages, list_sections, load_verb

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "verbs.md"
HEAD = """# All verbs of `ur`

Made by `tools/make_verbs_page.py` from the help: edit the verbs or their rows in `src/ur/cli/verbs/` instead.
`ur help VERB` prints the same in a terminal, and `ur help PROGRAM` describes a program of `ur list`.
"""
_LIMITS = re.compile(r"\s*\[[0-9.<=]*x[0-9.<>=]*\]$|; [0-9.<=]*x[0-9.<>=]*(?=\]$)")  # of a number, as click writes them


def make_page() -> str:
    """The page as Markdown: a table of all verbs, then each verb with its arguments, options and examples."""
    return "\n".join([HEAD, *_list_verbs(), *(line for name in VERBS for line in _describe(name))])


def _list_verbs() -> Iterator[str]:
    yield "| group | verb | purpose |"
    yield "|---|---|---|"
    for title, verbs in list_sections().items():
        for verb in verbs:
            yield f"| {title} | [`ur {verb.name}`](#ur-{verb.name}) | {_escape(verb.summary)} |"
    yield ""


def _describe(name: str) -> Iterator[str]:
    verb = load_verb(name)
    yield from _describe_command(verb, name, "##")
    if isinstance(verb, click.Group):
        for below in verb.commands:
            yield from _describe_command(verb.commands[below], f"{name} {below}", "###")


def _describe_command(command: click.Command, path: str, marks: str) -> Iterator[str]:
    context = click.Context(command, info_name=f"ur {path}")
    page = dict(list_pages())[path]
    positional = [each for each in command.params if isinstance(each, click.Argument)]
    yield f"{marks} `ur {path}`"
    yield ""
    options = any(isinstance(each, click.Option) for each in command.params)
    pieces = [each for each in command.collect_usage_pieces(context) if options or each != "[OPTIONS]"]
    yield f"    ur {path} {' '.join(pieces)}".rstrip()
    yield ""
    for paragraph in re.split(r"\n\s*\n", cleandoc(command.help or "").replace("\b", "").strip()):
        yield _escape(" ".join(paragraph.split()))
        yield ""
    for each, text in zip(positional, page.descriptions, strict=True):
        yield f"- `{each.make_metavar(context)}`: {_escape(text)}"
    if positional:
        yield ""
    yield from _list_options(command, context, path)
    yield "```bash"
    for line, meaning in page.examples:
        yield f"# {meaning}"
        yield line
    yield "```"
    yield ""


def _list_options(command: click.Command, context: click.Context, path: str) -> Iterator[str]:
    rows = [
        (each, record)
        for each in command.params
        if isinstance(each, click.Option) and (record := each.get_help_record(context)) is not None
    ]
    if not rows:
        return
    yield "| option | meaning |"
    yield "|---|---|"
    if path == "launch":
        order = [option for options in list_groups().values() for option in options]
        rows.sort(key=lambda row: min(order.index(each) for each in row[0].opts if each in order))
    for _, (written, text) in rows:
        written = re.sub(r"(INTEGER|FLOAT)( RANGE)?", "NUMBER", written)
        yield f"| {_code(written)} | {_escape(_LIMITS.sub('', text))} |"
    yield ""


def _code(text: str) -> str:
    """Code in a cell of a table, where a bar needs a backslash."""
    return f"`{text}`".replace("|", "\\|")


def _escape(text: str) -> str:
    """Keep what Markdown would read as markup, outside of code."""
    pieces = text.split("`")
    for at in range(0, len(pieces), 2):
        pieces[at] = re.sub(r"([<*_\[\]])", r"\\\1", pieces[at])
    return "`".join(pieces).replace("|", "\\|")


def main() -> None:
    """Write the page."""
    PAGE.write_text(make_page(), encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main()
