"""YAML within limits."""

import pytest

from ur.source.foreign.yaml_text import load_yaml

_BOMB = (
    "a: &a ["
    + "x," * 10
    + "]\n"
    + "".join(f"{c}: &{c} [" + f"*{p}," * 10 + "]\n" for p, c in zip("abcdefgh", "bcdefghi", strict=True))
)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[" * 200_000, "nested deeper than 100"),
        ("- " * 200_000, "nested deeper than 100|not allowed"),
        ("? " * 200_000, "nested deeper than 100|not allowed"),
        ("{a: " * 200_000, "nested deeper than 100"),
        (_BOMB, "more than 100,000 values"),
        ("a: &a [*a]", "more than 100,000 values"),
        ("a: &a " + "x" * 100_000 + "\nb: [" + "*a," * 1000 + "]", "more than 100,000 values"),
        ("a: 1" + ":59" * 500_000, "a number of"),
        ("a: 1" + ":59" * 500_000 + ".5", "a number of"),
        ("a: " + "9" * 900_000, "a number of"),
        ("".join(f"{n * (2**61 - 1)}: 0\n" for n in range(10, 40_000)), "a number of"),
        ("a: !!python/object:os.system x", "could not determine a constructor"),
        ("{[a]: b}", "unhashable"),
        ("{{a: b}: c}", "unhashable"),
        ("a: 2001-99-99", "month"),
        ("a: !!int x", "invalid literal"),
        ("a: [", "line 2"),
        ("a: \x01", "special characters|control characters"),
        ("a: \ud800", "surrogates|characters"),
        ("a\n---\nb", "single document"),
    ],
)
def test_text_that_cannot_be_used_is_refused_in_one_line(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason) as caught:
        load_yaml(text)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


def test_values_are_those_of_the_safe_loader() -> None:
    assert load_yaml("a: &a [1, 2.5, yes, 1:30]\nb: *a\n<<: {c: x}") == {
        "a": [1, 2.5, True, 90],
        "b": [1, 2.5, True, 90],
        "c": "x",
    }
    assert load_yaml("") is None
    assert len(load_yaml("[" + "1," * 100_100 + "]", 200_000)) == 100_100
