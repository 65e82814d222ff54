import pytest

from ur.launchfile.syntax import SubstitutionProblem, parse_substitutions


def test_pieces_and_words_know_where_they_stand() -> None:
    text = "x $(optenv HOME  two words) $$(arg a)"
    first, second = parse_substitutions(text)
    assert text[first.start : first.end] == "$(optenv HOME  two words)"
    assert [text[word.start : word.end] for word in first.words] == ["HOME", "two", "words"]
    assert text[second.start : second.end] == "$(arg a)"


@pytest.mark.parametrize("text", ["", "$", "$$", "$()", "$(arg a", "costs $5", "a (b) c", "$ (arg a)"])
def test_plain_text_holds_no_pieces(text: str) -> None:
    assert parse_substitutions(text) == ()


@pytest.mark.parametrize(("text", "offset"), [("$(arg $(arg a))", 6), ("$((a))", 2), ("$(arg (a))", 6), ("$($", 2)])
def test_nesting_is_refused_at_its_place(text: str, offset: int) -> None:
    with pytest.raises(SubstitutionProblem) as caught:
        parse_substitutions(text)
    assert caught.value.start == offset


def test_eval_takes_the_whole_value() -> None:
    (piece,) = parse_substitutions("$(eval (1 + 2) * arg('a'))")
    assert (piece.command, piece.content) == ("eval", "(1 + 2) * arg('a')")
