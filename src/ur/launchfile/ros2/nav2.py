"""Substitutions of nav2_common: parameter files that are rewritten when the launch starts.

Their text is the path of a temporary file; here it is `REWRITTEN`, a number, and the file's own path, and the content
is kept in the context. Source of the rules: nav2_common 1.3.
"""

import re
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, cast

from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.grammar import parse_text
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.parameters import ParameterSections
from ur.launchfile.ros2.substitutions import PERFORM, is_wanted, perform
from ur.source.file import Span

REWRITTEN = "/rewritten/"
_SECTION = re.compile(r"^([^\s#][^:\n]*):", re.MULTILINE)
_LARGE = 10**15
_POSE = ("x", "y", "z", "roll", "pitch", "yaw")


def read_content(path: str, context: Context, span: Span) -> object:
    """Return the content of a YAML file, rewritten or not. Raises DescriptionProblem."""
    known = context.rewritten.get(path)
    return _load(_read_text(path, context, span), path, span, context) if known is None else known


def read_sections(path: str, context: Context, span: Span) -> ParameterSections:
    """Return the sections of a parameter file as rcl reads them: it adds up those of one name. Raises as above."""
    if _is_unwritten(path, context):
        return ParameterSections(context.rewritten[path])
    text = _read_text(path, context, span)
    names = _SECTION.findall(text)
    if len(names) == len(set(names)):
        return ParameterSections(_load(text, path, span, context))
    import yaml  # few files

    from ur.source.foreign.yaml_text import compose_yaml, construct_yaml

    found = ParameterSections({})
    try:
        top = compose_yaml(text)
        if isinstance(top, yaml.MappingNode):
            parts = (construct_yaml(yaml.MappingNode(top.tag, [pair])) for pair in top.value)
            found.sections.extend(each for part in parts for each in ParameterSections(part).sections)
    except (ValueError, yaml.YAMLError) as problem:
        raise DescriptionProblem(f"{path}: {problem}, expected YAML", "bad-yaml", span, None, path) from None
    return found


def fill_file(path: str, context: Context, span: Span) -> str | Unknown:
    """Return the path of a parameter file in which substitutions are performed, as ParameterFile(allow_substs=True)."""
    if not context.is_file(path):
        return path
    if _is_unwritten(path, context):
        return _keep(path, context, context.rewritten[path], context.written[path])
    text = _read_text(path, context, span)
    is_plain = "$(" not in text and "\\" not in text
    filled = text if is_plain else perform(cast("list[object]", parse_text(text, span)), context)
    return filled if isinstance(filled, Unknown) else _keep(path, context, _load(filled, path, span, context), filled)


def _keep(path: str, context: Context, content: object, text: object) -> str:
    return context.keep_rewritten(f"{REWRITTEN}{len(context.rewritten)}{original_path(path)}", content, text)


def _read_text(path: str, context: Context, span: Span) -> str:
    try:
        return context.read(path).decode(errors="replace")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"{path}: {reason}, expected a parameter file"
        raise DescriptionProblem(message, "missing-file", span, context.near_file(path), path) from None


def _load(text: str, path: str, span: Span, context: Context) -> object:
    try:
        return context.load_yaml(text, shared=True)
    except ValueError as problem:
        raise DescriptionProblem(f"{path}: {problem}, expected YAML", "bad-yaml", span, None, path) from None


def _has_node_parameters(made: Made, context: Context) -> str | Unknown:
    path, node = perform(made.get("source_file"), context), perform(made.get("node_name"), context)
    for each in (path, node):
        if isinstance(each, Unknown):
            return each
    content = read_content(str(path), context, made.place("source_file"))
    return str(isinstance(content, Mapping) and str(node) in content)


def _rewrite(made: Made, context: Context) -> str | Unknown:
    path = perform(made.get("source_file"), context)
    if isinstance(path, Unknown):
        return path
    original = read_content(path, context, made.place("source_file"))
    changes: dict[str, dict[str, str]] = {}
    for name in ("param_rewrites", "key_rewrites", "value_rewrites"):
        given: Any = made.get(name) or {}
        if isinstance(given, Unknown):
            return given
        changes[name] = {}
        for key, value in given.items():
            text = perform(value, context)
            known = perform(key, context)
            for each in (text, known):
                if isinstance(each, Unknown):
                    return each
            changes[name][str(known)] = str(text)
    root = perform(made.get("root_key") or "", context)
    if isinstance(root, Unknown):
        return root
    types = made.get("convert_types", False) is True
    known_key = (id(original), repr(changes), root, types)
    if known_key not in context.rewrites:  # each node of a file may ask for the same
        context.rewrites[known_key] = (original, *_rewrite_content(original, changes, root, types=types))
    return _keep(path, context, *context.rewrites[known_key][1:])


def _rewrite_content(
    original: object, changes: Mapping[str, Mapping[str, str]], root: str, *, types: bool
) -> tuple[object, object]:
    """Return a content with changes, and its text or what makes it."""
    content = _copy(original)
    convert = partial(_convert, types=types)
    _replace_values(content, changes["param_rewrites"], convert)
    _replace_paths(content, changes["param_rewrites"], convert)
    content = _replace_texts(content, changes["value_rewrites"], convert)
    content = _rename_keys(content, changes["key_rewrites"])
    content = {root: content} if root else content
    from ur.source.foreign.yaml_text import DumpedYaml

    try:
        read_again = _read_again(content)
        return read_again, DumpedYaml(read_again)
    except (TypeError, ValueError):
        return content, str(DumpedYaml(content))


def _is_unwritten(path: str, context: Context) -> bool:
    """Return whether the text of a file has not been made, as its content says all."""
    return path in context.rewritten and not isinstance(context.written[path], str)


def _read_again(value: object) -> object:
    """Return a content as its text in YAML would be read. Raises TypeError and ValueError if only that text shows it.

    That text has no substitutions and no escapes.
    """
    if isinstance(value, dict):
        return {_read_again(key): _read_again(each) for key, each in sorted(value.items())}
    if isinstance(value, list):
        return [_read_again(each) for each in value]
    if isinstance(value, str):
        if not value.isascii() or not value.isprintable() or "\\" in value or "$(" in value:
            raise ValueError("its text has escapes")
    elif not (value is None or isinstance(value, float) or (isinstance(value, int) and abs(value) < _LARGE)):
        raise TypeError("a value of another type")
    return value


def _copy(value: object) -> object:
    if isinstance(value, dict):
        return {key: _copy(each) for key, each in value.items()}
    return [_copy(each) for each in value] if isinstance(value, list) else value


def _convert(text: str, *, types: bool) -> object:
    if types:
        try:
            return float(text) if "." in text else int(text)
        except ValueError:
            pass
    return {"true": True, "false": False}.get(text.lower(), text)


def _replace_values(content: object, changes: Mapping[str, str], convert: Callable[[str], object]) -> None:
    if isinstance(content, dict):
        for key, value in content.items():
            _replace_values(value, changes, convert)
            if str(key) in changes:
                content[key] = convert(changes[str(key)])


def _replace_paths(content: object, changes: Mapping[str, str], convert: Callable[[str], object]) -> None:
    for path, text in changes.items():
        *parts, last = path.split(".")
        place: Any = content
        for part in parts:
            if isinstance(place, list) and part.isdigit() and int(part) < len(place):
                place = place[int(part)]
            elif isinstance(place, dict) and (part in place or "ros__parameters" in (*parts, last)):
                place = place.setdefault(part, {})
            else:
                place = None
        if isinstance(place, dict) and (last in place or "ros__parameters" in parts):
            place[last] = convert(text)
        elif isinstance(place, list) and last.isdigit() and int(last) < len(place):
            place[int(last)] = convert(text)


def _replace_texts(content: object, changes: Mapping[str, str], convert: Callable[[str], object]) -> object:
    if isinstance(content, dict):
        return {key: _replace_texts(value, changes, convert) for key, value in content.items()}
    if isinstance(content, list):
        return [_replace_texts(value, changes, convert) for value in content]
    return convert(changes[str(content)]) if str(content) in changes else content


def _rename_keys(content: object, changes: Mapping[str, str]) -> object:
    if not isinstance(content, dict):
        return content
    return {changes.get(str(key), key): _rename_keys(value, changes) for key, value in content.items()}


def _replace_string(made: Made, context: Context) -> str | Unknown:
    path = perform(made.get("source_file"), context)
    if isinstance(path, Unknown):
        return path
    wanted = is_wanted(made.get("condition"), context)
    if isinstance(wanted, Unknown):
        return wanted
    if not wanted:
        return path
    text = _read_text(path, context, made.place("source_file"))
    given: Any = made.get("replacements") or {}
    if isinstance(given, Unknown):
        return given
    for key, value in given.items():
        new = perform(value, context)
        if isinstance(new, Unknown):
            return new
        text = text.replace(str(key), new)
    try:
        content = context.load_yaml(text)
    except ValueError:
        return Unknown(f"{path} is rewritten when the launch starts", made.span)
    return _keep(path, context, content, text)


def _parse_poses(made: Made, _: Context) -> str | Unknown:
    return Unknown("the poses of several robots come from the command line", made.span)


def read_poses(text: str, context: Context) -> dict[str, dict[str, float]]:
    """Return the poses of robots by name, written as `name={x: 1.0, yaw: 0.5}; other={...}`. Raises ValueError."""
    found = {}
    for part in filter(str.strip, text.split(";")):
        name, _, pose = part.partition("=")
        given = context.load_yaml(pose)
        if isinstance(given, dict):
            found[name.strip()] = {each: float(given.get(each, 0.0)) for each in _POSE}
    return found


def original_path(path: str) -> str:
    """Return the path of the file that was rewritten; the path itself for any other."""
    return re.sub(rf"{REWRITTEN}\d+", "", path) if path.startswith(REWRITTEN) else path


PERFORM |= {
    "HasNodeParams": _has_node_parameters,
    "ParseMultiRobotPose": _parse_poses,
    "ReplaceString": _replace_string,
    "RewrittenYaml": _rewrite,
}
