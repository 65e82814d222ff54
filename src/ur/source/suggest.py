"""Suggestions for misspelt names."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

CUTOFF = 0.6  # likeness from which a name is worth saying: difflib's ratio, 0 to 1
_MAX_LISTS = 32
_MAX_ANSWERS = 10_000


def did_you_mean(word: str, candidates: Iterable[str]) -> str | None:
    """Return the candidate nearest to a misspelt name, or None if none is similar enough.

    Options and other names are no candidates for each other. Dashes and the ending of launch files do not count. Of
    names that differ in case only, the last is used. Repeated calls with the same list, best one frozenset, are cheap.
    """
    return _index_of(frozenset(candidates), word.startswith("-")).nearest(word)


def suggest(word: str, candidates: Iterable[str]) -> str | None:
    """Return the help 'did you mean NAME?' for a misspelt name, or None, see `did_you_mean`."""
    near = did_you_mean(word, candidates)
    return f"did you mean {near}?" if near else None


def get_command(package: str) -> str:
    """Return the command that gets a package; with a placeholder for an invalid name that is unsafe in a shell."""
    plain = package.isascii() and package.replace("_", "").replace("-", "").isalnum() and package[0] != "-"
    return f"ur get {package if plain else 'PACKAGE'}"


def _strip(name: str) -> str:
    """Return what distinguishes a name from others of its kind: neither dashes nor `.launch.xml`, however misspelt."""
    stem, _, ending = name.lower().lstrip("-").partition(".")
    return stem if ending[:1] == "l" and set(ending) <= set("launch.xml") else name.lower().lstrip("-")


@lru_cache(maxsize=_MAX_LISTS)
def _index_of(candidates: frozenset[str], options: bool) -> _Index:
    return _Index(name for name in candidates if name.startswith("-") == options)


class _Index:
    """Names with the set of letters of each as bits, by which dissimilar names are skipped without a comparison.

    The results are those of difflib.get_close_matches, whose bounds cost more than its comparisons.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._bits: dict[tuple[str, int], int] = {}  # the n-th occurrence of a letter
        self._by_lower = {_strip(name): name for name in sorted(names)}
        self._letters = [(lower, len(lower), self._letters_of(lower)) for lower in self._by_lower]
        self._answers: dict[str, str | None] = {}

    def nearest(self, word: str) -> str | None:
        """See did_you_mean."""
        word = _strip(word)
        if word not in self._answers:
            if len(self._answers) >= _MAX_ANSWERS:
                self._answers.clear()
            self._answers[word] = self._find(word)
        return self._answers[word]

    def _letters_of(self, word: str) -> int:
        bits = 0
        counts: dict[str, int] = {}
        for letter in word:
            counts[letter] = count = counts.get(letter, 0) + 1
            bits |= 1 << self._bits.setdefault((letter, count), len(self._bits))
        return bits

    def _find(self, word: str) -> str | None:
        size, letters = len(word), self._letters_of(word)
        # The letters in common, whatever their order, are the most that the ratio can count.
        bounds = [
            (2.0 * (letters & own).bit_count() / (size + length) if size + length else 1.0, name)
            for name, length, own in self._letters
        ]
        possible = sorted((pair for pair in bounds if pair[0] >= CUTOFF), reverse=True)
        if not possible:
            return None
        from difflib import SequenceMatcher  # only needed once something is wrong

        matcher = SequenceMatcher()
        matcher.set_seq2(word)
        best: tuple[float, str] | None = None
        for bound, name in possible:
            if best is not None and bound < best[0]:
                break
            matcher.set_seq1(name)
            likeness = matcher.ratio()
            if likeness >= CUTOFF and (best is None or (likeness, name) > best):
                best = (likeness, name)
        return self._by_lower[best[1]] if best else None
