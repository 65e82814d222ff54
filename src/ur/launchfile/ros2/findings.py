"""Mistakes that upstream accepts: parameters that reach no node, programs that do not exist, arguments without a use.

Each is certain from the files that are there: where a build or a part that is not known could make it right, nothing is
reported.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ur.launchfile.plan.specs import NodeSpec, ParameterFile
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.model import Made
from ur.launchfile.ros2.nav2 import original_path
from ur.launchfile.ros2.parameters import ParameterSections, matches
from ur.launchfile.world.protocol import PackageNotFound
from ur.source.file import Span
from ur.source.suggest import did_you_mean

_EQUALS = re.compile(r"""['"]\s*==\s*['"]([^'"]*)['"]\s*""")
_BUILT = re.compile(r"add_executable\s*\(\s*\"?\$\{(?!PROJECT_NAME)|foreach\s*\(|file\s*\(\s*GLOB", re.IGNORECASE)
_BUILD_FILES = ("CMakeLists.txt", "setup.py", "setup.cfg", "pyproject.toml")


class Found(NamedTuple):
    """A warning, with the chain of its includes; the fields are those of a Diagnostic."""

    message: str
    rule: str
    span: Span
    help: str
    subject: str
    chain: tuple[Span, ...] = ()


def find_lost_parameters(
    nodes: Sequence[NodeSpec], read: Callable[[ParameterFile], ParameterSections | None]
) -> Iterator[Found]:
    """Yield files without `ros__parameters`, and nodes whose only parameter file has no section for them."""
    full_names = [node.full_name for node in nodes]
    reported: set[tuple[str, str]] = set()
    for node in nodes:
        files = [source for source in node.sources if isinstance(source, ParameterFile)]
        for source in files:
            path, origin = original_path(source.path), source.origin
            known = read(source)
            if known is None or (path, "") in reported:
                continue
            if not known.sections and known.is_mapping:
                reported.add((path, ""))
                message = f"{path} has no 'ros__parameters', expected it below the name of a node: its nodes end"
                help_ = "write NODE: {ros__parameters: {...}}, or /**: {ros__parameters: {...}} for all nodes"
                yield Found(message, "parameter-file", origin.span, help_, path, origin.includes)
            elif known.sections and len(files) == 1 and node.is_named and _is_lost(node, known):
                free = [name for name, _ in known.sections if not any(matches(name, each) for each in full_names)]
                near = _find_near(node.full_name, free)
                if near is None or (path, node.full_name) in reported:
                    continue
                reported.add((path, node.full_name))
                message = f"{path} has no section for {node.full_name}, which gets no other file"
                help_ = f"its section {near} names no node: rename it to {node.full_name}"
                yield Found(message, "parameter-section", origin.span, help_, near.strip("/"), origin.includes)


def _find_near(full_name: str, sections: Iterable[str]) -> str | None:
    """Return the section whose whole and last names are near: all those of one robot have its namespace."""
    known = {name.rpartition("/")[2]: name if name[0] == "/" else f"/{name}" for name in sections}
    near = did_you_mean(full_name.rpartition("/")[2], known)
    return did_you_mean(full_name, [known[near]]) if near is not None else None


def _is_lost(node: NodeSpec, known: ParameterSections) -> bool:
    return "<" not in node.full_name and not any(matches(name, node.full_name) for name, _ in known.sections)


def find_impossible(condition: object, choices: Mapping[str, Sequence[str]]) -> tuple[str, str] | None:
    """Return the argument, and the value that it never has, of a condition that never holds; else None."""
    if not isinstance(condition, Made):
        return None
    if condition.kind == "LaunchConfigurationEquals":
        name, text = condition.get("launch_configuration_name"), condition.get("expected_value")
    elif condition.kind == "IfCondition":
        name, text = _compared(condition.get("predicate_expression"))
    else:
        return None
    known = choices.get(name) if isinstance(name, str) else None
    is_impossible = known is not None and isinstance(text, str) and text not in known
    return (str(name), str(text)) if is_impossible else None


def _compared(value: object) -> tuple[object, object]:
    """Return the name and the text of `LaunchConfiguration(name) == text`; None for both if it is another value."""
    while isinstance(value, (list, tuple)) and len(value) == 1:
        value = value[0]
    if not isinstance(value, Made):
        return None, None
    if value.kind == "EqualsSubstitution":
        left, right = value.get("left"), value.get("right")
        left, right = (right, left) if isinstance(right, Made) else (left, right)
        return _name_of(left), right
    parts = value.get("expression") if value.kind == "PythonExpression" else None
    if isinstance(parts, (list, tuple)) and len(parts) == 3 and str(parts[0]).strip() in ("'", '"'):
        found = _EQUALS.fullmatch(parts[2]) if isinstance(parts[2], str) else None
        return (_name_of(parts[1]), found[1]) if found else (None, None)
    return None, None


def _name_of(value: object) -> object:
    is_configuration = isinstance(value, Made) and value.kind == "LaunchConfiguration"
    return value.get("variable_name") if is_configuration and isinstance(value, Made) else None


def find_executable(package: str, name: str, context: Context) -> tuple[bool, str | None]:
    """Return whether a package is certain not to have an executable, and one with nearly its name."""
    try:
        share = context.world.find_package(package)
    except (PackageNotFound, OSError, ValueError):
        return False, None
    if share.endswith(f"/share/{package}"):
        names = context.world.list_folder(f"{share.removesuffix(f'/share/{package}')}/lib/{package}")
        return bool(names) and name not in names, did_you_mean(name, names)
    files = context.files_of(share)
    if not set(_BUILD_FILES) & {parts[-1] for parts in files} or any(parts[-1].startswith(name) for parts in files):
        return False, None
    built = [parts for parts in files if parts[-1] in _BUILD_FILES or parts[-1].endswith(".cmake")]
    text = "\n".join(context.text_of("/".join((share, *parts))) for parts in built)
    text = text.replace("${PROJECT_NAME}", package)
    if _BUILT.search(text) or re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", text):
        return False, None
    return True, did_you_mean(name, re.findall(r"(?:add_executable\s*\(\s*|['\"])([\w-]+)", text))


def find_unused(declared: Mapping[str, Span], used: set[str], texts: Sequence[str]) -> Iterator[Span]:
    """Yield the places of arguments of a file that neither it nor a file that it includes names a second time."""
    for name, span in declared.items():
        word = re.compile(rf"(?<!\w){re.escape(name)}(?!\w)")
        is_written = name not in used and span.text.strip("'\"") == name
        if is_written and len(word.findall(span.file.text)) < 2 and not any(word.search(text) for text in texts):
            yield span
