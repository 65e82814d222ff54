"""Expressions cost what they compute: the expensive are refused, and nothing reaches beyond what is given."""

import os
import sys
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest
from tests.limits import run_limited

from ur.launchfile.load import load_plan
from ur.launchfile.plan.values.budget import Budget, ExpressionProblem
from ur.launchfile.plan.values.expression import evaluate_expression
from ur.launchfile.world.memory import MemoryWorld

ROOT = Path(__file__).parents[3]
CPU_SECONDS, MEMORY_KB = 10, 200_000  # of `ur check` on one file

EXPENSIVE = [
    "prod([10**50000] * 1000000)",
    "prod([3] * 190000)",
    "prod(['x' * 1000000] * 1000)",
    "prod([1, 'x' * 1000, 1000000])",
    "(lambda f: [f([3] * 60000) for x in range(10000)])(prod)",
    "(lambda f: f(f, 60))(lambda f, n: (f(f, n-1),) * 2 if n else ()) == 1",
    "hash((lambda f: f(f, 60))(lambda f, n: (f(f, n-1),) * 2 if n else ()))",
    "(lambda x: {x: 1})((lambda f: f(f, 60))(lambda f, n: (f(f, n-1),) * 2 if n else ()))",
    "(lambda x: x in [x, x])((lambda f: f(f, 60))(lambda f, n: (f(f, n-1),) * 2 if n else ()))",
    "('{0:9999}' * 100000).format(1)",
    "('%9999d' * 100) % ((1,) * 100)",
    "'{:{w}}'.format(1, w=30000000)",
    "f'{1:{10 ** 8}}'",
    "format(1, '100000000')",
    "{x * (2**61 - 1) for x in range(20000)}",
    "set([x * (2**61 - 1) for x in range(20000)])",
    "{x * (2**61 - 1): 1 for x in range(20000)}",
    "dict([(x * (2**61 - 1), 1) for x in range(20000)])",
    "[pow(3, 1 << 2000, (1 << 2000) - 1) for x in range(1000)]",
    "[pow(3, 1 << 190000, (1 << 190000) - 1) for x in [1]]",
    "[(1 << 199000) // (3 * (1 << 99000) - 1) for x in range(100000)]",
    "(lambda g: [g((1 << 199000) - 1, 3 ** 40000) for x in range(10000)])(gcd)",
    "(lambda g: [g(1 << 199000) for x in range(10000)])(isqrt)",
    "(lambda g: [g(2000, 1000) for x in range(1000000)])(comb)",
    "list(map(([1] * 100000).count, range(100000)))",
    "(lambda f: [f([0] * 100000) for x in range(1000)])(sorted)",
    "[list(zip(range(100000), range(100000))) for x in range(1000)]",
    "[(lambda: 0) for x in range(1000000)]",
    "str([['x' * 1000] * 1000] * 1000)",
    "[1 for a in ['x' * 1000000] for b in range(1000000) if 'y' in a]",
]
PLAIN = [
    "1 + 2 * 3",
    "'{0[1]} {n!r}'.format([1, 2], n='x')",
    "'{:{w}.{p}f}|{:>8}|{!s}'.format(3.14159, 'a', None, w=10, p=2)",
    "'{:.2f} {{}} {}'.format(1, 2)",
    "'{0.real} {0.imag}'.format(2)",
    "'%05.1f %s %%' % (3.14159, 'a')",
    "'%(a)s' % {'a': 1}",
    "prod([1, 2, 3.5]) + prod([2, 3], start=4) + prod(range(1, 20))",
    "lcm(4, 6) + gcd(12, 18) + isqrt(17) + comb(10, 3)",
    "sorted([3, 1, 2], key=lambda x: -x)",
    "len([0] * 1000000)",
    "sum(range(1000000))",
    "sum([x * x for x in range(10000)])",
    "{x % 7 for x in range(1000)} & {1, 2, 3}",
    "dict(a=1)['a'] + {'b': 2}.get('b')",
    "max([[1, 2], [1, 3]]) < [2]",
    "','.join(sorted(set('hello')))",
    "hash(17) + int(pow(2, 10))",
    "list(zip([1, 2], 'ab'))",
]


def evaluate(text: str, budget: Budget | None = None) -> str:
    return evaluate_expression(text, {"env": os.environ.get}, {"a": 1}.__getitem__, (), budget)


@pytest.mark.parametrize("expression", EXPENSIVE)
def test_expensive_expression_is_refused(expression: str) -> None:
    with pytest.raises(ExpressionProblem):
        evaluate(expression)


@pytest.mark.parametrize("expression", PLAIN)
def test_plain_expression_is_what_python_says(expression: str) -> None:
    import math

    known = {name: getattr(math, name) for name in dir(math) if not name.startswith("_")}
    assert evaluate(expression) == str(eval(expression, known))


@pytest.mark.parametrize(
    "text",
    [
        "('{0._' + '_globals_' + '_[os].environ}').format(env)",
        "('{0.func._' + '_globals_' + '_}').format(env)",
        "('{0._' + '_class_' + '_}').format('')",
        "'{0.format}'.format('')",
        "'{0.keys}'.format({'a': 1})",
    ],
)
def test_format_reaches_no_attributes_but_those_of_numbers(text: str) -> None:
    with pytest.raises(ExpressionProblem, match="may be used in a format"):
        evaluate(text)


def test_expressions_of_a_file_share_what_they_may_cost() -> None:
    budget = Budget()
    costly = "sum([x for x in range(200000)])"
    assert evaluate(costly, budget)
    with pytest.raises(ExpressionProblem, match="together"):
        [evaluate(costly, budget) for _ in range(100)]
    assert budget.left == 0
    with pytest.raises(ExpressionProblem, match="together"):
        evaluate("1", budget)


def test_finding_names_the_expression_that_costs_too_much() -> None:
    text = '<launch>\n  <arg name="a" default="$(eval 1 + 1)"/>\n  <arg name="b" default="$(eval [1] * 3)"/>\n</launch>'
    text = text.replace("[1] * 3", "prod([3] * 190000)")
    (found,) = load_plan(["/a.launch"], [], MemoryWorld({"/a.launch": text})).diagnostics
    assert (found.rule, found.message) == ("bad-eval", "$(eval): takes too long to compute")
    assert found.span is not None
    assert (found.span.position.line, found.span.text) == (3, "prod([3] * 190000)")


def test_check_of_one_file_stays_within_its_limits(tmp_path: Path) -> None:
    options = "".join(f'<arg name="flip{n}" default="false"/><group if="$(arg flip{n})"/>\n' for n in range(30))
    hostile = "".join(
        f'<arg name="a{n}_{again}" default={quoteattr(f"$(eval {each})")}/>\n'
        for again in range(5)
        for n, each in enumerate([*EXPENSIVE, "len([x for x in range(100000)])"])
    )
    (tmp_path / "a.launch").write_text(f"<launch>\n{options}{hostile}</launch>\n")

    command = [sys.executable, "-I", "-m", "ur", "check", "a.launch"]
    used = run_limited(command, CPU_SECONDS, tmp_path, {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)})
    assert used.code == 1, used.output[-2000:]
    assert "too long to compute" in used.output
    assert used.memory < MEMORY_KB
