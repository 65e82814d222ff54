"""Grouping by case: values that are the same in all cases are written once, others with their cases."""

from collections.abc import Iterable

from ur.docs.documents import BaseCase, Value


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
