"""Formatting: paths and values that are the same on every computer, grouped by case, and links of comments."""

import posixpath
import re
from collections.abc import Callable, Iterable, Mapping, Sequence

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.docs.documents import BaseCase, Value
from ur.docs.repository.collect import is_elsewhere, show_elsewhere
from ur.launchfile.plan.one_file import HERE
from ur.launchfile.syntax import Element

_LINK = re.compile(r"(!?)\[([^\[\]\n]{0,500})\]\(\s*([^)\s]+)\s*\)")
_SCHEME = re.compile(r"[a-zA-Z][a-zA-Z0-9+.-]*:")


def settle_links(text: str, folder: str, exists: Callable[[str], bool]) -> str:
    """Return Markdown whose relative links start at the root of the repository; dead links become plain text.

    `folder` is the folder of the text, relative to the root; `exists` is called with a path relative to the root, too.
    """

    def settle(match: re.Match[str]) -> str:
        mark, label, target = match.groups()
        if _SCHEME.match(target) or target.startswith("//"):
            return match.group()
        path, hash_, fragment = target.partition("#")
        for base in (folder, ""):
            whole = posixpath.normpath(posixpath.join(base, path))
            if path and not path.startswith("/") and not whole.startswith("..") and exists(whole):
                return f"{mark}[{label}]({whole}{hash_}{fragment})"
        return label

    return _LINK.sub(settle, text) if "](" in text else text


def map_links(text: str, place: Callable[[str], str]) -> str:
    """Return Markdown in which `place` maps each relative link."""

    def replace(match: re.Match[str]) -> str:
        mark, label, target = match.groups()
        if _SCHEME.match(target) or target.startswith("//"):
            return match.group()
        return f"{mark}[{label}]({place(target)})"

    return _LINK.sub(replace, text) if "](" in text else text


def vary(pairs: Iterable[tuple[BaseCase, str]], cases: tuple[BaseCase, ...]) -> tuple[Value, ...]:
    """Return the texts of some cases as values; one that applies in all cases names none."""
    groups: dict[str, list[BaseCase]] = {}
    for case, text in pairs:
        groups.setdefault(text, []).append(case)
    if len(groups) == 1:
        ((text, where),) = groups.items()
        return (Value(text, () if len(where) == len(cases) else tuple(where)),)
    return tuple(Value(text, tuple(where)) for text, where in groups.items())


def name_cases(cases: Iterable[BaseCase]) -> str:
    """Return a display text: `stage, magni (plain, lidar)`; the variants of a base are grouped."""
    by_base: dict[str, list[str]] = {}
    for case in cases:
        by_base.setdefault(case.base, []).append(case.variant)
    return ", ".join(_name_base(base, variants) for base, variants in by_base.items())


def _name_base(base: str, variants: list[str]) -> str:
    named = [variant for variant in variants if variant]
    if not named:
        return base
    plain = "plain, " if "" in variants else ""
    return f"{base} ({plain}{', '.join(named)})"


_ONE_ARGUMENT = re.compile(r"\s*\$\(arg\s+(\w+)\)\s*\Z")
_EVAL = re.compile(r"\s*\$\(eval\s+(.*)\)\s*\Z", re.DOTALL)
_MARKER = re.compile(r"uǂ(\d+)ǂ")
_NUMBER = re.compile(r"[-+]?(?:\d+\.\d*|\.?\d+)(?:[eE][-+]?\d+)?\Z")
_FILE = re.compile(r".*\.\w{1,6}\Z|.*(?:_file|_path|_url)\Z")
_TYPES = {"int": "whole number", "double": "number", "bool": "true or false", "yaml": "YAML"}


class Words:
    """Formats values of one launch file: without the folders of this computer, unknown ones by their names."""

    def __init__(self, view: LaunchView, packages: Mapping[str, str]) -> None:
        """Create the formatter. `packages`: by folder; a folder that is not a package has no name."""
        self._folders = sorted(packages.items(), key=lambda pair: -len(pair[0]))
        self._required = [name for name, elements in view.declared.items() if all(map(_is_required, elements))]

    def show(self, text: str, given: Mapping[str, str] | None = None) -> str:
        """Return a value in a form that is valid on every computer."""
        if "/" in text:
            text = text.replace(HERE, "").replace(HERE.rstrip("/"), "")
            for folder, name in self._folders:
                if folder in text:
                    text = text.replace(folder, f"$(find {name})") if name else text.replace(f"{folder}/", "")
        if "ǂ" not in text:
            return text
        unknown = [name for name in self._required if name not in (given or {})]

        def name_of(match: re.Match[str]) -> str:
            number = int(match.group(1))
            return f"$(arg {unknown[number]})" if number < len(unknown) else "$(env ...)"

        text = _MARKER.sub(name_of, text)
        return show_elsewhere(text) if is_elsewhere(text) else re.sub(r"/ǂ([\w.-]+)", r"$(find \1)", text)


def describe_condition(element: Element) -> str:
    """Describe `if` and `unless` of a tag; empty if it has neither."""
    parts = []
    for word in ("if", "unless"):
        value = element.attributes.get(word)
        if value is not None:
            match = _ONE_ARGUMENT.match(value) or _EVAL.match(value)
            parts.append(f"{word} `{' '.join((match.group(1) if match else value).split())}`")
    return " and ".join(parts)


def describe_type(name: str, default: str | None, used: Mapping[str, str]) -> str:
    """Describe the values of an argument, from its uses, its default and its name."""
    if name == "robot_base":
        return "base"
    if name == "robot_variant":
        return "variant"
    if name == "machine" or name.endswith("_machine"):
        return "computer"
    if name.endswith("_pkg"):
        return "package"
    if name in used:
        return used[name]
    text = (default or "").strip()
    if text.lower() in ("true", "false"):
        return "true or false"
    if _NUMBER.match(text):
        return "number" if "." in text or "e" in text.lower() else "whole number"
    if (text.startswith(("$(find", "$(dirname", "/")) and "/" in text) or _FILE.match(text) or _FILE.match(name):
        return "file"
    return "text"


def types_from_use(view: LaunchView) -> dict[str, str]:
    """Return types of arguments that are a condition, or the value of a parameter with a type."""
    found: dict[str, str] = {}
    for element, _ in walk_elements(view.tree.launch):
        attributes = element.attributes
        for condition in ("if", "unless"):
            match = _ONE_ARGUMENT.match(attributes[condition]) if condition in attributes else None
            if match:
                found[match.group(1)] = "true or false"
        if "type" in attributes and element.name == "param":
            match = _ONE_ARGUMENT.match(attributes.get("value", ""))
            if match and attributes["type"] in _TYPES:
                found.setdefault(match.group(1), _TYPES[attributes["type"]])
    return found


def _is_required(element: Element) -> bool:
    return "default" not in element.attributes and "value" not in element.attributes


def join_words(words: Sequence[str]) -> str:
    """Return `a, b and c`."""
    return f"{', '.join(words[:-1])} and {words[-1]}" if len(words) > 1 else "".join(words)
