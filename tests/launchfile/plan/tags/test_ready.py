"""`ready:` comments: conditions with full names, and what is none of them."""

import pytest

from ur.launchfile.plan.specs import ReadyCondition
from ur.launchfile.plan.tags.nodes import is_ready_comment, parse_ready


def test_conditions_are_read_with_names_in_full() -> None:
    text = " ready: topic scan 5 Hz; service ~reset\n frame /map; action /move_base; topic odom; process; "
    assert parse_ready(text, "/deep/node", "/deep/") == (
        (
            ReadyCondition("topic", "/deep/scan", 5.0),
            ReadyCondition("service", "/deep/node/reset"),
            ReadyCondition("frame", "map"),
            ReadyCondition("action", "/move_base"),
            ReadyCondition("topic", "/deep/odom"),
            ReadyCondition("process", ""),
        ),
        (),
    )


@pytest.mark.parametrize(
    "wrong", ["topics scan", "scan", "topic", "topic a b", "service x 5 Hz", "topic x 0 Hz", "topic 5", "topic x 5"]
)
def test_what_is_no_condition_is_told_and_the_others_stay(wrong: str) -> None:
    conditions, told = parse_ready(f"ready: {wrong}; topic good", "/n", "/")
    assert told == (wrong,)
    assert conditions == (ReadyCondition("topic", "/good"),)


def test_only_comments_that_begin_so_are_conditions() -> None:
    assert is_ready_comment(" ready : topic x")
    assert not is_ready_comment("already: topic x")
    assert not is_ready_comment("when ready: topic x")
