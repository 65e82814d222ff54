"""Rules by id, collected from the modules below `rules/`, without a separate list."""

from collections.abc import Iterable
from functools import cache
from importlib import import_module
from pkgutil import walk_packages

from ur.check import rules
from ur.check.rule import Rule, RuleGroup
from ur.source.diagnostic import UserError, user_error
from ur.source.suggest import suggest


@cache
def load_rules() -> dict[str, Rule]:
    """Return all rules, sorted by id."""
    modules = (each.name for each in walk_packages(rules.__path__, f"{rules.__name__}.") if not each.ispkg)
    found: list[Rule] = [rule for name in modules for rule in import_module(name).RULES]
    return {rule.id: rule for rule in sorted(found, key=lambda rule: rule.id)}


def choose_rules(select: Iterable[str], ignore: Iterable[str]) -> frozenset[str]:
    """Return the rule ids chosen by `--select` (empty: all) and `--ignore`, ids or group codes. Raises UserError."""
    every = load_rules()
    chosen = {id_ for word in select for id_ in _ids(word, every, "--select")} or set(every)
    return frozenset(chosen - {id_ for word in ignore for id_ in _ids(word, every, "--ignore")})


def find_rule(word: str) -> Rule:
    """Find the rule with this id. Raises UserError with a suggestion."""
    every = load_rules()
    if word in every:
        return every[word]
    raise _unknown(word, every, "--explain", ())


def list_rules() -> str:
    """Return all rules by group, one line each: the id and the summary."""
    every = load_rules()
    width = max(map(len, every))
    lines = []
    for group in RuleGroup:
        lines += ["", f"{group.value}:"]
        lines += [f"  {rule.id:{width}}  {rule.summary}" for rule in every.values() if rule.group is group]
    return "\n".join(lines[1:]) + "\n"


def _ids(word: str, every: dict[str, Rule], option: str) -> list[str]:
    if word in every:
        return [word]
    groups = tuple(group.value for group in RuleGroup)
    if word in groups:
        return [rule.id for rule in every.values() if rule.group.value == word]
    raise _unknown(word, every, option, groups)


def _unknown(word: str, every: dict[str, Rule], option: str, groups: tuple[str, ...]) -> UserError:
    kinds = f" or a group ({', '.join(groups)})" if groups else ""
    return user_error(
        f"{option} {word}: no such rule, expected an id{kinds}",
        rule="unknown-rule",
        help=suggest(word, [*every, *groups]) or "'ur check --explain' lists the rules",
        subject=option,
    )
