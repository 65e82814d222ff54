"""Links of the pages lead somewhere, every page is in the index, and the commands of `ur` in them exist."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from ur.cli.verbs import VERBS, load_verb

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
INDEX = DOCS / "README.md"
PAGES = {
    str(path.relative_to(ROOT)): path
    for path in (*sorted(ROOT.glob("*.md")), *sorted(DOCS.rglob("*.md")), *sorted((ROOT / "src").rglob("README.md")))
    if "rules" not in path.parts
}
_FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(?<!\\)\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
_CODE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
_NAME = re.compile(r"[a-z]+")


def anchors_of(path: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub makes them."""
    text = _FENCE.sub("", path.read_text(encoding="utf-8"))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in _HEADING.findall(text)}


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_to_files_and_headings(name: str) -> None:
    page = PAGES[name]
    for target in _LINK.findall(_FENCE.sub("", page.read_text(encoding="utf-8"))):
        if "://" in target:
            continue
        file, _, anchor = target.partition("#")
        path = (page.parent / file).resolve() if file else page
        assert path.exists(), f"{name}: {target}"
        if anchor and path.suffix == ".md":
            assert anchor in anchors_of(path), f"{name}: {target}"


def test_index_names_every_page() -> None:
    named = {(DOCS / target).resolve() for target in _LINK.findall(INDEX.read_text(encoding="utf-8"))}
    missing = [name for name, path in PAGES.items() if DOCS in path.parents and path not in {INDEX, *named}]
    assert not missing, f"docs/README.md names no {', '.join(missing)}"


def commands_of(text: str) -> Iterator[list[str]]:
    """The arguments of every `ur ...` in blocks of code and in code within a line."""
    blocks = [block.partition("\n")[2].removesuffix("```") for block in _FENCE.findall(text)]
    rest = _FENCE.sub("", text)
    lines = [line for block in blocks for line in block.splitlines()]
    lines += [line for line in rest.splitlines() if line.startswith("    ")]
    lines += [code.replace("\\|", "|") for code in _CODE.findall(rest)]
    for line in lines:
        for part in re.split(r"\||&&|;|\$\(", line):
            found = re.match(r"\s*(?:[A-Z_]+=\S+ )*(?:\./)?ur ([a-z].*)", part)
            if found:
                try:
                    yield shlex.split(found[1].rstrip(")\"' "), comments=True)
                except ValueError:
                    continue  # a sentence with an apostrophe


def options_of(command: click.Command) -> set[str]:
    return {option for each in command.params for option in (*each.opts, *each.secondary_opts)} | {"--help"}


@pytest.mark.parametrize("name", [name for name in PAGES if name != "CHANGELOG.md"])  # which names what was removed
def test_verbs_and_options_exist(name: str) -> None:
    for words in commands_of(PAGES[name].read_text(encoding="utf-8")):
        verb, path = words[0].rstrip(",.:"), words[0]
        if not _NAME.fullmatch(verb) or verb == "help":
            continue
        assert verb in VERBS, f"{name}: ur {' '.join(words)}"
        command = load_verb(verb)
        if isinstance(command, click.Group) and len(words) > 1 and _NAME.fullmatch(words[1]):
            assert words[1] in command.commands, f"{name}: ur {' '.join(words)}"
            command, path = command.commands[words[1]], f"{path} {words[1]}"
        if verb in ("x", "shell", "boot", "run", "new"):
            continue  # what follows belongs to another program
        for word in words[1:]:
            option = word.partition("=")[0].rstrip(",.:")
            if option.startswith("--") and len(option) > 2:
                assert option in options_of(command), f"{name}: ur {path} has no {option}"


def test_a_page_has_commands_that_are_looked_at() -> None:
    text = (DOCS / "how-to" / "from-roslaunch.md").read_text(encoding="utf-8")
    assert ["launch", "--except", "NODE"] in list(commands_of(text))
    assert sum(1 for _ in commands_of(text)) > 30
