"""Make docs/reference/verbs.md from the help of every verb. A test compares what is committed with this."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from inspect import cleandoc
from pathlib import Path

import click

from ur.cli.launch.command import list_groups
from ur.cli.verbs import VERBS, list_pages, list_sections, load_verb

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "verbs.md"
HEAD = """# All verbs of `ur`

Made by `tools/make_verbs_page.py` from the help: edit the verbs or their rows in `src/ur/cli/verbs/` instead.
`ur help VERB` prints the same in a terminal, with more examples; `ur help PROGRAM` describes a program of `ur list`.
"""
_EXAMPLES = 2  # of a verb
SHARED = "Options and arguments of several verbs"
_OFTEN = 3
"""In how many commands an option or argument stands, with the same text, to be described once for all of them."""
_LIMITS = re.compile(r"\s*\[[0-9.<=]*x[0-9.<>=]*\]$|; [0-9.<=]*x[0-9.<>=]*(?=\]$)")  # of a number, as click writes them


def make_page() -> str:
    """The page as Markdown: links to all verbs, what several have, then each verb with what is its own."""
    commands = [each for name in VERBS for each in _walk(name)]
    found = Counter(line for command, path in commands for line in _list_parameters(command, path))
    shared = [line for line, count in found.items() if count >= _OFTEN and line[3] in "-["]
    described = [line for command, path in commands for line in _describe(command, path, shared)]
    return "\n".join([HEAD, *_list_verbs(), f"## {SHARED}", "", *shared, "", *described])


def _list_verbs() -> Iterator[str]:
    for title, verbs in list_sections().items():
        yield f"- **{title}**: {', '.join(f'[`{each.name}`](#ur-{each.name})' for each in verbs)}"
    yield ""


def _walk(name: str) -> Iterator[tuple[click.Command, str]]:
    verb = load_verb(name)
    yield verb, name
    if isinstance(verb, click.Group):
        yield from ((command, f"{name} {below}") for below, command in verb.commands.items())


def _describe(command: click.Command, path: str, shared: Sequence[str]) -> Iterator[str]:
    usage = [each for each in command.collect_usage_pieces(click.Context(command)) if each != "[OPTIONS]"]
    yield f"{'###' if ' ' in path else '##'} `ur {path}`"
    yield ""
    for paragraph in re.split(r"\n\s*\n", cleandoc(command.help or "").replace("\b", "").strip()):
        yield _escape(" ".join(paragraph.split()))
        yield ""
    lines = list(_list_parameters(command, path))
    own = [line for line in lines if line not in shared]
    also = [line.partition("`: ")[0].removeprefix("- ") + "`" for line in lines if line in shared]
    if also:
        own.append(f"- [also](#{SHARED.lower().replace(' ', '-')}) {', '.join(also)}")
    yield from [f"    ur {path} {' '.join(usage)}".rstrip(), ""]
    if " " not in path:
        examples = dict(list_pages())[path].examples[:_EXAMPLES]
        yield from (f"    {line}  # {meaning}" for line, meaning in examples if line != f"ur {path}")
        yield ""
    yield from [*own, ""] if own else ()


def _list_parameters(command: click.Command, path: str) -> Iterator[str]:
    """The arguments of a command, then its options, each with its meaning."""
    context = click.Context(command, info_name=f"ur {path}")
    positional = [each for each in command.params if isinstance(each, click.Argument)]
    for each, text in zip(positional, dict(list_pages())[path].descriptions, strict=True):
        yield f"- `{each.make_metavar(context)}`: {_escape(text)}"
    rows = [
        (option, record)
        for option in command.params
        if isinstance(option, click.Option) and (record := option.get_help_record(context)) is not None
    ]
    if path == "launch":
        order = [option for options in list_groups().values() for option in options]
        rows.sort(key=lambda row: min(order.index(each) for each in row[0].opts if each in order))
    for _, (written, text) in rows:
        written = re.sub(r"(INTEGER|FLOAT)( RANGE)?", "NUMBER", written)
        yield f"- `{written}`: {_escape(_LIMITS.sub('', text))}"


def _escape(text: str) -> str:
    """Keep what Markdown would read as markup, outside of code."""
    pieces = text.split("`")
    for at in range(0, len(pieces), 2):
        pieces[at] = re.sub(r"([<*_\[\]])", r"\\\1", pieces[at])
    return "`".join(pieces)


def main() -> None:
    """Write the page."""
    PAGE.write_text(make_page(), encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main()
