"""Texts of attributes: `$(find ...)`, `$(arg ...)` and the others as ROS 2 writes them."""

import re

from ur.launchfile.syntax import Substitution, SubstitutionProblem, is_eval, parse_substitutions
from ur.tools.convert.expressions import NotConvertible, Want, convert_expression

_PLAIN_WORD = re.compile(r"[^\s'\"\\$()]+")


def convert_text(text: str, want: Want = "any") -> str:
    """A value of ROS 1 as a value of ROS 2; an expression's is used as `want`. Raises NotConvertible."""
    if is_eval(text):
        return convert_expression(text[len("$(eval ") : -1], want)
    try:
        found = parse_substitutions(text)
    except SubstitutionProblem as problem:
        raise NotConvertible(problem.message, problem.help or "ur check explains it") from None
    parts, place = [], 0
    for each in found:
        parts += [_escape(text[place : each.start]), _convert(each)]
        place = each.end
    return "".join([*parts, _escape(text[place:])])


def quote_template(text: str) -> str:
    """A converted text as one word inside `$(...)`."""
    if '"' not in text:
        return f'"{text}"'
    return f"'{text}'" if "'" not in text else '"' + text.replace('"', '\\"') + '"'


def _escape(text: str) -> str:
    return text.replace("\\", "\\\\")


def _convert(each: Substitution) -> str:
    words = [word.text for word in each.words]
    if each.command == "arg" and len(words) == 1:
        return f"$(var {words[0]})"
    if each.command == "find" and len(words) == 1:
        return f"$(find-pkg-share {words[0]})"
    if each.command == "dirname":
        return "$(dirname)"
    if each.command == "anon" and len(words) == 1:
        return f"$(anon {words[0]})"
    if each.command == "env" and len(words) == 1:
        return f"$(env {words[0]})"
    if each.command == "optenv" and words:
        return f"$(env {words[0]} {_word(' '.join(words[1:]))})"
    raise NotConvertible(f"$({each.content})", "ur check explains it")


def _word(text: str) -> str:
    return text if _PLAIN_WORD.fullmatch(text) else quote_template(_escape(text))
