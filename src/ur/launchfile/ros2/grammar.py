"""Substitutions in XML and YAML: `$(command words)`, nested and quoted, as upstream's grammar has them."""

import re
from collections.abc import Mapping

from ur.launchfile.ros2.model import DescriptionProblem, Made
from ur.source.arguments import split_words
from ur.source.file import Span
from ur.source.suggest import did_you_mean

_IDENTIFIER = re.compile(r"[A-Za-z][\w-]*", re.ASCII)
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_STOPS = {quote: re.compile(rf"\\|\$\({'|' if quote else ''}{quote}") for quote in ("", "'", '"')}
_DEEPEST = 40

# Command: kind, arguments in their order (a `*` takes all that are left), the least number of them.
COMMANDS: Mapping[str, tuple[str, tuple[str, ...], int]] = {
    "all": ("AllSubstitution", ("*conditions",), 1),
    "and": ("AndSubstitution", ("left", "right"), 2),
    "anon": ("AnonName", ("name",), 1),
    "any": ("AnySubstitution", ("*conditions",), 1),
    "command": ("Command", ("command", "on_stderr"), 1),
    "dirname": ("ThisLaunchFileDir", (), 0),
    "env": ("EnvironmentVariable", ("name", "default_value"), 1),
    "equals": ("EqualsSubstitution", ("left", "right"), 2),
    "eval": ("PythonExpression", ("expression", "python_modules"), 1),
    "exec-in-pkg": ("ExecutableInPackage", ("executable", "package"), 2),
    "file-content": ("FileContent", ("path",), 1),
    "filename": ("ThisLaunchFile", (), 0),
    "find-exec": ("FindExecutable", ("name",), 1),
    "find-pkg-prefix": ("FindPackagePrefix", ("package",), 1),
    "find-pkg-share": ("FindPackageShare", ("package",), 1),
    "for-var": ("ForEachVar", ("name", "default_value"), 1),
    "if": ("IfElseSubstitution", ("condition", "if_value", "else_value"), 2),
    "index": ("ForLoopIndex", ("name",), 1),
    "launch_log_dir": ("LaunchLogDir", (), 0),
    "log_dir": ("LaunchLogDir", (), 0),
    "not": ("NotSubstitution", ("value",), 1),
    "not-equals": ("NotEqualsSubstitution", ("left", "right"), 2),
    "optenv": ("EnvironmentVariable", ("name", "default_value"), 1),
    "or": ("OrSubstitution", ("left", "right"), 2),
    "param": ("ParameterSubstitution", ("name",), 1),
    "path-join": ("PathJoinSubstitution", ("*substitutions",), 1),
    "string-join": ("StringJoinSubstitution", ("delimiter", "*substitutions"), 1),
    "var": ("LaunchConfiguration", ("variable_name", "default"), 1),
}
_RENAMED = {"find": "find-pkg-share", "arg": "var", "executable-in-package": "exec-in-pkg"}


def parse_text(text: str, span: Span) -> list[str | Made]:
    """Return the texts and substitutions of a text at `span`. Raises DescriptionProblem."""
    return _Parser(text, span).read_template()


def parse_command(text: str, span: Span) -> list[list[str | Made]]:
    """Return the words of a command line, as upstream's `_parse_cmdline` splits them. Raises DescriptionProblem."""
    words: list[list[str | Made]] = []
    word: list[str | Made] = []
    for part in parse_text(text, span):
        if isinstance(part, Made):
            word.append(part)
            continue
        try:
            tokens = split_words(part)
        except ValueError as problem:
            raise DescriptionProblem(f"the command line has {str(problem).lower()}", "launch-value", span) from None
        if not tokens:
            words.append(word)
            word = []
            continue
        if part[0].isspace() and word:
            words.append(word)
            word = []
        word.append(tokens[0])
        if len(tokens) > 1:
            words.append(word)
            words.extend([token] for token in tokens[1:-1])
            word = [tokens[-1]]
        if part[-1].isspace():
            words.append(word)
            word = []
    return [each for each in [*words, word] if each]


class _Parser:
    def __init__(self, text: str, span: Span) -> None:
        self._text, self._span, self._at, self._depth = text, span, 0, 0

    def read_template(self, quote: str = "") -> list[str | Made]:
        """Read up to the end, or up to a quotation mark that is not escaped."""
        parts: list[str | Made] = []
        start = self._at
        while (stop := _STOPS[quote].search(self._text, self._at)) is not None:
            self._at = stop.start()
            if stop[0] == "\\":
                self._at += 2
            elif stop[0] == quote:
                break
            else:
                self._add(parts, start)
                parts.append(self._read_substitution())
                start = self._at
        else:
            self._at = max(self._at, len(self._text))
        self._add(parts, start)
        return parts or [""]

    def _add(self, parts: list[str | Made], start: int) -> None:
        if start < self._at:
            parts.append(_ESCAPE.sub(r"\1", self._text[start : self._at]))

    def _read_substitution(self) -> Made:
        start = self._at
        self._depth += 1
        if self._depth > _DEEPEST:
            raise self._problem("nested too deep", start)
        self._at += 2
        found = _IDENTIFIER.match(self._text, self._at)
        name = found[0] if found else ""
        self._at += len(name)
        words: list[list[str | Made]] = []
        while self._at < len(self._text) and self._text[self._at] == " ":
            self._at += 1
            words.append(self._read_value(start))
        if self._at >= len(self._text) or self._text[self._at] != ")":
            raise self._problem(f"'{self._text[start : start + 40]}' does not end, expected ')'", start)
        self._at += 1
        self._depth -= 1
        return self._make(name, words, start)

    def _read_value(self, start: int) -> list[str | Made]:
        text = self._text
        if self._at < len(text) and text[self._at] in "'\"":
            quote = text[self._at]
            self._at += 1
            parts = self.read_template(quote)
            if self._at >= len(text):
                raise self._problem(f"a quotation mark {quote} is not closed", start)
            self._at += 1
            return parts
        parts = []
        begin = self._at
        while self._at < len(text) and text[self._at] not in " )":
            if text[self._at] == "\\":
                self._at += 2
            elif text.startswith("$(", self._at):
                self._add(parts, begin)
                parts.append(self._read_substitution())
                begin = self._at
            else:
                self._at += 1
        self._add(parts, begin)
        if not parts:
            raise self._problem("a word is missing, expected one space between words", start)
        return parts

    def _make(self, name: str, words: list[list[str | Made]], start: int) -> Made:
        span = self._place(start)
        command = COMMANDS.get(name)
        if command is None:
            present = _RENAMED.get(name)
            near = present or did_you_mean(name, COMMANDS)
            of = " of ROS 1" if present else ""
            help_ = f"write $({near} ...)" if near else f"known: {', '.join(sorted(COMMANDS))}"
            message = f"$({name} ...) is a substitution{of} that ROS 2 does not know"
            raise DescriptionProblem(message, "bad-substitution", span, help_, name)
        kind, names, least = command
        values: dict[str, object] = {}
        left = list(words)
        for each in names:
            if each.startswith("*"):
                values[each[1:]] = left
                left = []
            elif left:
                values[each] = left.pop(0)
        if left or len(words) < least:
            most = len(names)
            wanted = f"{least}" if most == least else f"{least} to {most}"
            raise self._problem(f"$({name} ...) has {len(words)} words, expected {wanted}", start)
        if kind == "EnvironmentVariable" and name == "optenv":
            values.setdefault("default_value", "")
        if "python_modules" in values:
            values["python_modules"] = [each.strip() for each in "".join(map(str, words[1])).split(",")]
        return Made(kind, values, span)

    def _place(self, start: int) -> Span:
        whole = self._span
        shift = whole.file.text.find(self._text, whole.start, whole.end)
        first = (whole.start if shift < 0 else shift) + start
        return Span(whole.file, min(first, whole.end), min(first + self._at - start, whole.end))

    def _problem(self, message: str, start: int) -> DescriptionProblem:
        return DescriptionProblem(message, "bad-substitution", self._place(start))
