import pytest

from ur.check.catalogue import choose_rules, find_rule, load_rules
from ur.source.diagnostic import UserError


def test_all_rules_are_chosen_without_words() -> None:
    assert choose_rules([], []) == frozenset(load_rules())


def test_group_and_id_are_added_and_taken_away() -> None:
    yaml = {"bad-yaml", "duplicate-key", "bad-base", "bad-map", "bad-world", "misread-value"}
    assert choose_rules(["yaml"], []) == yaml
    assert choose_rules(["yaml", "bad-xml"], ["duplicate-key"]) == yaml - {"duplicate-key"} | {"bad-xml"}


@pytest.mark.parametrize("option", ["select", "ignore"])
def test_unknown_word_is_refused_with_a_suggestion(option: str) -> None:
    words = (["bad-yml"], []) if option == "select" else ([], ["bad-yml"])
    with pytest.raises(UserError) as caught:
        choose_rules(*words)
    assert caught.value.diagnostics[0].help == "did you mean bad-yaml?"


def test_unknown_rule_to_explain_is_refused() -> None:
    with pytest.raises(UserError, match="--explain bad-yml"):
        find_rule("bad-yml")
