"""Values of the launch API as texts of XML and YAML: `$(command words)`, quoted as upstream's grammar has it."""

import re
import shlex
from collections.abc import Callable, Iterable
from pathlib import PurePosixPath

from ur.launchfile.ros2.grammar import COMMANDS
from ur.launchfile.ros2.model import Made, Unknown
from ur.source.file import Span
from ur.tools.convert.expressions import NotConvertible

_NAMES = {kind: (name, words) for name, (kind, words, _) in reversed(tuple(COMMANDS.items())) if name != "optenv"} | {
    "FindPackage": ("find-pkg-prefix", ("package",))
}
_PLAIN = re.compile(r"[^\s'\"\\$()]+")
_BY_HAND = "write this part by hand, or include the Python file"
Split = Callable[[str, Span], Iterable[str | Made]]


class Unwritable(NotConvertible):
    """A value that no text stands for, with its span."""

    def __init__(self, message: str, span: Span | None, help: str = _BY_HAND) -> None:
        super().__init__(message, help)
        self.span = span


class Templates:
    """Writes values. `split` finds what a text was made of."""

    def __init__(self, split: Split) -> None:
        self._split = split
        self.lets: list[tuple[str, str]] = []
        """Variables to set before a tag: upstream's grammar has no quotation marks inside of others."""
        self._variables = 0

    def write(self, value: object, span: Span, quote: str = "") -> str:
        """Return a text with substitutions; `quote` is the quotation mark around it. Raises Unwritable."""
        return "".join(
            self._substitution(part, quote) if isinstance(part, Made) else escape(part, quote)
            for part in self.parts(value, span)
        )

    def parts(self, value: object, span: Span) -> list[str | Made]:
        """Return the texts and substitutions that a value consists of. Raises Unwritable."""
        if isinstance(value, (str, PurePosixPath, int, float)):
            return list(self._split(str(value), span))
        if isinstance(value, (list, tuple)):
            return [part for each in value for part in self.parts(each, span)]
        if isinstance(value, Made):
            flat = _FLAT.get(value.kind)
            return [value] if flat is None else flat(self, value)
        if isinstance(value, Unknown):
            raise Unwritable(value.reason, value.span or span)
        raise Unwritable("a text of a class of the file", span)

    def command(self, words: Iterable[object], span: Span) -> str:
        """Return a command line, whose words are split again as they are here. Raises Unwritable."""
        return " ".join(
            "".join(
                self._substitution(part, "") if isinstance(part, Made) else escape(shlex.quote(part), "")
                for part in _without_empty(self.parts(word, span))
            )
            for word in words
        )

    def _substitution(self, made: Made, quote: str) -> str:
        if made.kind == "LaunchConfigAsBool":
            variable = Made("LaunchConfiguration", {"variable_name": made.get("name")}, made.span)
            expression = ["'", variable, "'.lower() in ('true', 'on', 'yes', '1', 't', 'y')"]
            made = Made("PythonExpression", {"expression": expression}, made.span)
        if made.kind not in _NAMES:
            raise Unwritable(f"{made.kind} has no counterpart", made.span)
        command, names = _NAMES[made.kind]
        words: list[object] = []
        for name in names:
            if name.startswith("*"):
                words += self._listed(made.get(name[1:]))
            elif name == "python_modules" and made.get(name):
                words.append(",".join(map(str, self._listed(made.get(name)))))
            elif made.get(name) is not None:
                words.append(made.get(name))
        if made.kind == "IfElseSubstitution" and made.get("if_value") is None:
            words.insert(1, "")
        texts = [self._word(word, made, quote) for word in words]
        if quote and any(text[:1] in ("'", '"') for text in texts):
            self._variables += 1
            self.lets.append((f"value_{self._variables}", f"$({' '.join([command, *texts])})"))
            return f"$(var value_{self._variables})"
        return f"$({' '.join([command, *texts])})"

    def _listed(self, value: object) -> list[object]:
        return list(value) if isinstance(value, (list, tuple)) else [value]

    def _word(self, value: object, made: Made, quote: str) -> str:
        if isinstance(value, bool) and made.kind.endswith("EqualsSubstitution"):
            value = str(value).lower()  # as it compares flags
        parts = self.parts(value, made.place("expression"))
        if all(isinstance(part, Made) or _PLAIN.fullmatch(part) for part in parts):
            return self.write(parts, made.span, quote)
        quote = "'" if not any(isinstance(part, str) and "'" in part for part in parts) else '"'
        return quote + self.write(parts, made.span, quote) + quote

    def join(self, made: Made) -> list[str | Made]:
        """Return the parts of a joined path."""
        joined: list[str | Made] = []
        for item in self._listed(made.get("substitutions")):
            parts = _without_empty(self.parts(item, made.span)) if item != "" else [""]
            if isinstance(parts[0], str) and parts[0].startswith("/"):
                joined = []
            elif joined and not (isinstance(joined[-1], str) and joined[-1].endswith("/")):
                joined.append("/")
            joined += parts
        return joined

    def chain(self, made: Made) -> list[str | Made]:
        """Return the parts of joined texts."""
        found: list[str | Made] = []
        for index, item in enumerate(self._listed(made.get("substitutions"))):
            found += [
                *(self.parts(made.get("delimiter", ""), made.span) if index else []),
                *self.parts(item, made.span),
            ]
        return found


def _without_empty(parts: list[str | Made]) -> list[str | Made]:
    return [part for part in parts if part != ""] or [""]


_FLAT: dict[str, Callable[[Templates, Made], list[str | Made]]] = {
    "PathJoinSubstitution": Templates.join,
    "PathSubstitution": lambda templates, made: templates.parts(made.get("path"), made.span),
    "StringJoinSubstitution": Templates.chain,
    "TextSubstitution": lambda templates, made: templates.parts(made.get("text", ""), made.span),
}


def escape(text: str, quote: str) -> str:
    """Return a plain text as a template has it."""
    text = text.replace("\\", "\\\\").replace("$(", "\\$(")
    return text.replace(quote, f"\\{quote}") if quote else text
