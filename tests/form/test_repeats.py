"""One implementation of a thing: no function of src, and none of the tests, stands in two modules."""

from collections import defaultdict
from collections.abc import Mapping

from tests.form.facts import Facts, find_facts

LEAST = 3  # lines of a body; shorter ones are alike by chance


def find_repeats(modules: Mapping[str, Facts], *, methods: bool = False) -> list[list[str]]:
    """Functions at the top of modules, and `methods`, with the same arguments and statements in several modules."""
    places: dict[str, list[str]] = defaultdict(list)
    for path, each in modules.items():
        for function in each.functions:
            if function.text.count("\n") >= LEAST and (methods or not function.is_nested):
                places[function.text].append(f"{path} {function.name}")
    return [found for found in places.values() if len({place.split()[0] for place in found}) > 1]


def test_no_function_stands_in_two_modules(modules: Mapping[str, Facts]) -> None:
    assert find_repeats(modules) == [], "move it into a module below both, and import it"


def test_no_function_and_no_method_of_tests_stands_in_two_modules(facts: Mapping[str, Facts]) -> None:
    tests = {path: each for path, each in facts.items() if path.startswith("tests/")}
    found = find_repeats(tests, methods=True)
    assert found == [], "move it to tests/fakes, or to the conftest.py of the folder that both are in"


def test_repeats_are_found_whatever_their_names_and_docstrings() -> None:
    one = find_facts('def f(x: int) -> int:\n    """One."""\n    y = x\n    # a comment\n    y += 1\n    return y\n')
    other = find_facts("def g(x: int) -> int:\n    y = x\n\n    y += 1\n    return y\n")
    assert find_repeats({"a": one, "b": other}) == [["a f", "b g"]]
    assert find_repeats({"a": one}) == []
    short = find_facts("def f(x: int) -> int:\n    return x\n")
    assert find_repeats({"a": short, "b": short}) == []
