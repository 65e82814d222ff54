"""Secrets in texts and in bytes of messages, found by the names that they have, by their form, and by their values."""

import base64
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from urllib.parse import quote

_FOREIGN = "mot_?de_?passe|contrase[nñ]a|senha|wachtwoord|l[oö]senord|has[lł]o|пароль|密码|密碼|パスワード|비밀번호"
_STRONG = re.compile(
    "passwd|passwor[dt]|kennwort|passphrase|passcode|secret|token|api[_-]?key|access[_-]?key|private[_-]?key|credential"
    f"|psk|ssid|authorization|cookie|{_FOREIGN}"
)
_WEAK = frozenset({"pass", "pwd", "pw", "auth", "key", "keys", "pin", "wpa", "bearer"})  # parts of other words, too
_LETTERS = re.compile("[a-z]+")
_PART = re.compile(
    f"pass|kennwort|secret|token|credential|psk|ssid|cookie|pwd?|auth|key|pin|wpa|bearer|{_FOREIGN}", re.IGNORECASE
)
"""Part of each name of a secret. Most lines have none, and to look at each word takes much longer."""

_WORD = re.compile(r"[\w.-]+")
_ASSIGNED = re.compile(
    r"[\"']?[ \t]{0,8}(?::=|=|(?P<colon>:))\s{0,40}(?:[|>][+-]?\s{1,40})?"
    r"(?:\"(?P<a>[^\"\n]+)\"|'(?P<b>[^'\n]+)'|(?P<c>[\[{(][^\n]*?\w[^\n]*)"
    r"|(?P<d>(?![\[{(]|[a-zA-Z]{0,2}\\?[\"'`])(?(colon)[^\n\"'<>]+|[^\s\"'&;<>]+)))"
)
_BESIDE = re.compile(  # an argument, an item of a tuple, a text with a prefix or within a text; an element
    r"[\\\"'`]{0,2}[^\w\n\"'`]{0,6}[a-zA-Z]{0,2}(?:\"\"\"|'''|\\?[\"'`])(?P<a>[^\"'`\n]+?)\\?[\"'`]"
    r"|>(?P<b>[^<>\n]+)</"
)
_OPTION = re.compile(r"\s{1,40}(?:\"(?P<a>[^\"\n]*)\"|'(?P<b>[^'\n]*)'|(?P<c>[^\s\"'-][^\s\"']*))")
_FORMS: tuple[tuple[str, re.Pattern[str]], ...] = (
    ("private key", re.compile(r"(?P<a>-----BEGIN [A-Z ]{0,40}PRIVATE KEY-----[\s\S]*?(?:-----END [A-Z ]*-----|\Z))")),
    ("password in an address", re.compile(r"://(?P<a>[^/\s@\"'<>]+)@")),
    ("authorization", re.compile(r"\b(?:bearer|basic|digest)\s+(?P<a>[\w.~+/=-]{8,})", re.IGNORECASE)),
    (
        "token",
        re.compile(
            r"\b(?P<a>gh[pousr]_\w{16,}|github_pat_\w{16,}|glpat-[\w-]{16,}|sk-[\w-]{16,}|AKIA[0-9A-Z]{12,}"
            r"|xox[abprs]-[\w-]{10,}|AIza[\w-]{30,}|(?<![\w-])eyJ[\w-]{8,}\.[\w-]+\.[\w-]+)"
        ),
    ),
    ("name of a home folder", re.compile(r"/(?:home|Users)/(?P<a>[^/\s:\"'<>,;)\]}]+)")),
)
_NAMED = "value with the name of a secret"
_LEAST = 4  # characters of a value that is removed wherever it stands
_MOST_WORK = 5_000_000_000  # characters that are compared, of all texts and values
_PLAIN = frozenset({"true", "false", "none", "null", "auto", "default", "home", "root"})

Removed = Counter[tuple[str, str]]
"""The number of removed secrets, by file and kind."""


class SecretFilter:
    """Learns the values of secrets, then removes them. `removed` counts what it has removed."""

    def __init__(self, most_work: int = _MOST_WORK) -> None:
        self._most_work = most_work
        self._values: dict[str, str] = {}  # as they stand in texts, with their kinds
        self.removed: Removed = Counter()
        self._work = 0

    def learn(self, values: object, name: str = "") -> None:
        """Learn the values of a tree of mappings and lists whose names are those of secrets."""
        if isinstance(values, Mapping):
            for key, value in values.items():
                below = str(key) if not is_secret_name(name) else name
                self.learn(value, below)
        elif isinstance(values, list | tuple):
            before = ""
            for each in values:
                self.learn(each, before or name)
                option = each.lstrip("-") if isinstance(each, str) and each.startswith("-") else ""
                before = option if is_secret_name(option) else ""
        elif is_secret_name(name):
            self._keep(str(values), _NAMED)

    def learn_text(self, text: str) -> None:
        """Learn the values that a text gives away."""
        for begin, end, kind in _spans(text):
            self._keep(text[begin:end], kind)

    def _keep(self, value: str, kind: str) -> None:
        for each in (value.strip(), *(re.split(r"[:@]", value) if kind == "password in an address" else ())):
            if len(each) >= _LEAST and each.lower() not in _PLAIN and not each.startswith("[removed"):
                for form in _forms(each) if each not in self._values else ():
                    self._values.setdefault(form, kind)

    def clean(self, text: str, file: str) -> str:
        """A text without secrets."""
        spans = list(self._find(text, utf8=False))
        parts = []
        place = 0
        for begin, end, kind in _merge(spans):
            parts += [text[place:begin], f"[removed: {kind}]"]
            self.removed[file, kind] += 1
            place = end
        return "".join([*parts, text[place:]])

    def clean_values(self, values: object, file: str, name: str = "") -> object:
        """As `clean`, for a tree of mappings, lists and values."""
        if isinstance(values, Mapping):
            return {
                self.clean(str(key), file): self.clean_values(value, file, name if is_secret_name(name) else str(key))
                for key, value in values.items()
            }
        if isinstance(values, list | tuple):
            return [self.clean_values(each, file, name) for each in values]
        if is_secret_name(name) and values not in (None, "", True, False):
            self.removed[file, _NAMED] += 1
            return "[removed: value with the name of a secret]"
        return self.clean(values, file) if isinstance(values, str) else values

    def clean_bytes(self, data: bytes, file: str) -> bytes:
        """Bytes of a message with `*` in place of secrets: its lengths stay what they were."""
        text = data.decode("latin-1")
        found = _merge(list(self._find(text, utf8=True)))
        if not found:
            return data
        made = bytearray(data)
        for begin, end, kind in found:
            made[begin:end] = b"*" * (end - begin)
            self.removed[file, kind] += 1
        return bytes(made)

    def _find(self, text: str, *, utf8: bool) -> Iterator[tuple[int, int, str]]:
        yield from _spans(text)
        self._work += len(text) * len(self._values)
        if self._work > self._most_work:
            yield 0, len(text), "text: too many secrets to look for"
            return
        for form, kind in self._values.items():
            sought = form.encode().decode("latin-1") if utf8 else form
            place = text.find(sought)
            while place >= 0:
                yield place, place + len(sought), kind
                place = text.find(sought, place + len(sought))


def is_secret_name(name: str) -> bool:
    """Return whether a parameter, a variable or an argument of this name has a secret for a value."""
    last = name.rpartition("/")[2].lower()
    return _STRONG.search(last) is not None or not _WEAK.isdisjoint(_LETTERS.findall(last))


def _forms(value: str) -> tuple[str, ...]:
    packed = base64.b64encode(value.encode("utf-8", "surrogatepass")).decode().rstrip("=")
    forms = {value, quote(value, safe="", errors="replace"), packed, value.replace("\\", "\\\\").replace('"', '\\"')}
    return tuple(each for each in forms if len(each) >= _LEAST)


def _spans(text: str) -> Iterator[tuple[int, int, str]]:
    for kind, pattern in _FORMS:
        for match in pattern.finditer(text):
            if not match["a"].startswith("[removed"):
                yield *match.span("a"), kind
    place = 0
    while part := _PART.search(text, place):
        line = max(place, text.rfind("\n", place, part.start()) + 1)
        word = next(each for each in _WORD.finditer(text, line) if each.end() > part.start())
        place = word.end()
        if not is_secret_name(word[0]):
            continue
        value = _ASSIGNED.match(text, place)
        if value is None:
            value = _BESIDE.match(text, place)
        if value is None and word[0].startswith("-"):
            value = _OPTION.match(text, place)
        if value is not None and value.lastgroup is not None:
            place = value.end()
            if value[value.lastgroup].strip() and not value[value.lastgroup].startswith("[removed"):
                yield *value.span(value.lastgroup), _NAMED


def _merge(spans: Iterable[tuple[int, int, str]]) -> list[tuple[int, int, str]]:
    merged: list[tuple[int, int, str]] = []
    for begin, end, kind in sorted(spans):
        if merged and begin < merged[-1][1]:
            first, last, before = merged[-1]
            merged[-1] = (first, max(last, end), before)
        else:
            merged.append((begin, end, kind))
    return merged
