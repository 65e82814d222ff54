"""Candidates in files beside launch files: keys and values of YAML files, and headings of programs."""

from __future__ import annotations

import re

from ur.complete.yaml_keys import find_parents, plain_parents
from ur.lsp.completion.candidate import Candidate
from ur.lsp.programs.yaml_keys import know_keys
from ur.lsp.workspace import Workspace

_HEADINGS = {
    "Summary": "One line, which `ur list` and the documentation show.",
    "Overview": "Markdown, which goes on in the lines below that begin with `## `.",
    "Publishes": "Topics that the node publishes, each in backticks.",
    "Subscribes": "Topics that the node subscribes to, each in backticks.",
    "Offers": "Services that the node offers, each in backticks.",
    "Calls": "Services that the node calls, each in backticks.",
    "Actions": "Actions that the node serves, each in backticks.",
    "Uses": "Actions that the node sends goals to, each in backticks.",
    "Python": "Needed Python packages: `lock file: modules: name and size`.",
    "Debian": "Needed Debian packages: `private parameter: packages | other packages: name and size`.",
    "File": "A needed file: `private parameter of its path: private parameter of the condition: how to make it`.",
}


def complete_heading(text: str, offset: int) -> list[Candidate]:
    """Candidates for `##Heading:` lines of a program."""
    start = text.rfind("\n", 0, offset) + 1
    typed = text[start:offset]
    if not text.startswith("#!") or start == 0 or not re.fullmatch(r"#{1,2}\w*", typed):
        return []
    end = offset + len(re.match(r"\w*:?", text[offset:])[0])  # type: ignore[index]
    given = {each for each in _HEADINGS if re.search(rf"^##{each}:", text, re.MULTILINE)}
    return [
        Candidate(f"##{name}:", "attribute", f"##{name}: ", start, end, "", document)
        for name, document in _HEADINGS.items()
        if name not in given and f"##{name}:".startswith(typed)
    ]


def complete_yaml(workspace: Workspace, path: str, text: str, offset: int) -> list[Candidate]:
    """The candidates at a place of a YAML file: keys at the start of an item, values behind `key: `."""
    parents, before = find_parents(text, offset)
    value = re.search(r"([\w./~-]{1,200}) {0,50}: {1,50}([^{}\[\],#]*)\Z", before)
    typed = value[2] if value is not None else re.search(r"[\w./~-]{0,500}\Z", before)[0]  # type: ignore[index]
    start = offset - len(typed)
    rest = re.match(r"[\w./~-]*", text[offset:])
    end = offset + (len(rest[0]) if rest is not None else 0)
    known = know_keys(workspace, path, text)
    if value is not None:
        here = known.get(plain_parents(parents), {}).get(value[1])
        values = here.values if here is not None else {}
        return [Candidate(each, "value", each, start, end) for each in values if each.startswith(typed)]
    if before.strip(" -") != typed and not re.search(r"[{,] *[\w./~-]*\Z", before):
        return []
    colon = "" if text[end : end + 1] == ":" else ":"
    return [
        Candidate(
            name, "attribute", f"{name}{colon}{' ' if colon and not each.nested else ''}", start, end, "", each.document
        )
        for name, each in known.get(plain_parents(parents), {}).items()
        if name.startswith(typed) and name != text[start:end]
    ]
