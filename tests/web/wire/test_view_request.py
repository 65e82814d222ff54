"""What a page asks to see."""

import json
import random

import pytest
from tests.fuzz.mutate import mutate

from ur.web.wire.frames import Layer
from ur.web.wire.reading import BadRequestError
from ur.web.wire.requests import LONGEST, ViewRequest, read_view, read_view_message

ALWAYS = {Layer.NONE, Layer.MAP}


def test_message_asks_for_the_same_as_the_address() -> None:
    for values in ({"layers": "plan,local"}, {"layers": "", "plots": ""}, {"layers": "scan", "plots": "/a:x,/b:y.z"}):
        assert read_view_message(json.dumps(values)) == read_view(values)


def test_plots_are_a_layer_while_they_are_open() -> None:
    assert read_view({"layers": "plan"}) == ViewRequest(frozenset({*ALWAYS, Layer.PLAN}))
    opened = read_view({"layers": "", "plots": "/a:x"})
    assert opened == ViewRequest(frozenset({*ALWAYS, Layer.PLOTS}), frozenset({"/a:x"}))


def test_eight_plots_with_the_longest_names_fit_in() -> None:
    plots = [f"/{letter * 100}:{'.'.join(['f' * 40] * 7)}" for letter in "abcdefgh"]
    text = json.dumps({"layers": "scan,plan", "plots": ",".join(plots)})
    assert read_view_message(text).plots == set(plots)


@pytest.mark.parametrize(
    "data",
    [
        None,
        b'{"layers": ""}',
        "",
        "{}",
        "[]",
        "[" * 3000,
        '{"t": "stop"}',
        '{"layers": 1}',
        '{"layers": null}',
        '{"layers": "../x"}',
        '{"layers": "", "plots": "odom"}',
        '{"layers": "", "more": ""}',
        '{"layers": "' + "," * LONGEST + '"}',
    ],
)
def test_anything_else_is_refused(data: object) -> None:
    with pytest.raises(BadRequestError):
        read_view_message(data)


def test_mutated_messages_are_read_or_refused() -> None:
    chance = random.Random(7)
    seeds = [b'{"layers": "scan,plan", "plots": "/odom:twist.linear.x"}', b'{"layers": ""}']
    for _ in range(3000):
        data = mutate(seeds, (b"NaN", b"null", b"[", b"{", b"\\u0000", b"\xff", b":"), chance)
        try:
            found = read_view_message(data.decode("utf-8", "replace"))
        except BadRequestError:
            continue
        assert found.layers >= ALWAYS
