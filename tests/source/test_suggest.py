from difflib import get_close_matches

from hypothesis import given
from hypothesis import strategies as st

from ur.source.suggest import CUTOFF, did_you_mean

NAMES = st.text("abAB_1é", max_size=8)


@given(word=NAMES, candidates=st.lists(NAMES, max_size=12))
def test_suggestion_is_the_one_of_difflib(word: str, candidates: list[str]) -> None:
    by_lower = {name.lower(): name for name in sorted(candidates)}
    near = get_close_matches(word.lower(), by_lower, n=1, cutoff=CUTOFF)
    assert did_you_mean(word, candidates) == (by_lower[near[0]] if near else None)


def test_long_names_are_compared_as_difflib_compares_them() -> None:
    word, names = "ab" * 150, ["ab" * 149, "ba" * 150, "a" * 300]
    assert did_you_mean(word, names) == next(iter(get_close_matches(word, names, n=1, cutoff=CUTOFF)), None)


def test_nothing_is_suggested_where_nothing_is_near() -> None:
    assert did_you_mean("amcl", ["rviz", "gmapping"]) is None
    assert did_you_mean("amcl", []) is None


def test_only_names_of_one_kind_whose_own_letters_agree_are_suggested() -> None:
    assert did_you_mean("--topics", ["--topic", "topics"]) == "--topic"
    assert did_you_mean("--topics", ["topics"]) is None
    assert did_you_mean("--world", ["--port"]) is None
    assert did_you_mean("nofile.launch", ["n_patrol.launch.xml", "m_wander.launch"]) is None
    assert did_you_mean("wandr.launch", ["n_patrol.launch.xml", "wander.launch.xml"]) == "wander.launch.xml"
