"""Generated launch files mean to us what they mean to roslaunch."""

from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

NAMES = st.sampled_from(["a", "b", "c", "d"])
TEXTS = st.sampled_from(
    [
        "",
        "1",
        "0",
        "2.5",
        "true",
        "False",
        "text",
        "two words",
        "/global",
        "~private",
        "a/b",
        "1e3",
        " 7 ",
        "a//b/",
        "-",
        "é",
    ]
)


def _mostly(good: Any, *others: Any) -> Any:
    """A strategy that rarely leaves what roslaunch accepts: most generated files are to mean something."""
    return st.integers(0, 24).flatmap(lambda number: good if number else st.one_of(*others))


FRESH = st.sampled_from([f"n{number}" for number in range(40)])
WORDS = st.sampled_from(["1", "0", "2.5", "true", "False", "text", "two words", "a/b", "1e3", " 7 ", "é", "/g"])
WILD = st.one_of(
    TEXTS,
    NAMES.map(lambda name: f"$(arg {name})"),
    NAMES.map(lambda name: f"$(anon {name})"),
    st.sampled_from(
        [
            "$(find corpus_pkg)",
            "$(find nowhere)",
            "$(env HOME)",
            "$(optenv NOT_SET d e)",
            "$(dirname)",
            "$(arg)",
            "$",
            "$(",
        ]
    ),
)
EXPRESSIONS = st.recursive(
    st.one_of(
        NAMES, NAMES.map(lambda name: f"arg('{name}')"), st.sampled_from(["1", "2.5", "'x'", "True", "pi", "[1, 2]"])
    ),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/", "//", "%", "==", "<", "and", "or", "in"]), inner).map(
            lambda parts: f"({parts[0]} {parts[1]} {parts[2]})"
        ),
        inner.map(lambda part: f"not {part}"),
        inner.map(lambda part: f"str({part})"),
        inner.map(lambda part: f"len({part})"),
        st.tuples(inner, inner, inner).map(lambda parts: f"({parts[0]} if {parts[1]} else {parts[2]})"),
    ),
    max_leaves=6,
)
GOOD_PIECES = st.one_of(
    WORDS,
    WORDS,
    NAMES.map(lambda name: f"$(arg {name})"),
    NAMES.map(lambda name: f"$(anon {name})"),
    st.sampled_from(
        ["$(find corpus_pkg)", "$(env HOME)", "$(optenv NOT_SET d e)", "$(dirname)/x", "$(find corpus_pkg)/params"]
    ),
)
PIECES = _mostly(GOOD_PIECES, WILD)
VALUES = st.one_of(
    PIECES,
    PIECES,
    st.lists(PIECES, min_size=2, max_size=3).map("".join),
    EXPRESSIONS.map(lambda text: f"$(eval {text})"),
)
FLAGS = _mostly(st.sampled_from(["true", "false", "True"]), st.sampled_from(["1", "yes", ""]))
BOOLEANS = _mostly(
    st.sampled_from(["true", "false", "1", "0", "True", "$(eval 1 < 2)"]), st.sampled_from(["yes", "$(arg a)"])
)
SPACES = _mostly(st.sampled_from(["s", "/s", "a/b", "$(arg d)", "$(anon s)"]), PIECES)


def _tag(name: str, attributes: dict[str, str], inside: str = "") -> str:
    written = "".join(f" {key}={quoteattr(value)}" for key, value in attributes.items())
    return f"<{name}{written}>{inside}</{name}>\n"


@st.composite
def _attributes(draw: Any, required: dict[str, Any], optional: dict[str, Any]) -> dict[str, str]:
    chosen = {name: draw(strategy) for name, strategy in required.items()}
    for name, strategy in optional.items():
        if draw(st.integers(0, 9)) < 2:
            chosen[name] = draw(strategy)
    condition = draw(st.integers(0, 19))
    if condition < 3:
        chosen["if" if condition else "unless"] = draw(BOOLEANS)
    return chosen


ARG = st.one_of(
    _attributes({"name": _mostly(FRESH, NAMES)}, {"default": VALUES}),
    _attributes({"name": _mostly(FRESH, NAMES), "default": VALUES}, {}),
    _attributes({"name": _mostly(FRESH, NAMES), "value": VALUES}, {"doc": WORDS}),
).map(lambda attributes: _tag("arg", attributes))
PASSED = _attributes({"name": NAMES, "value": VALUES}, {}).map(lambda attributes: _tag("arg", attributes))
PARAM = _attributes(
    {"name": st.one_of(NAMES, PIECES), "value": VALUES},
    {
        "type": _mostly(
            st.sampled_from(["str", "auto", "string"]), st.sampled_from(["int", "double", "bool", "yaml", "x"])
        )
    },
).map(lambda attributes: _tag("param", attributes))
YAML = _mostly(
    st.sampled_from(["a: 1", "{a: {b: 2}, c: [1, x]}", "", "a: deg(90)", "a: $(arg a)", "/x: 1\n~y: 2", "a: ~"]),
    st.sampled_from(["[1, 2]", "5", "a: [1", "1: x"]),
)
ROSPARAM = st.tuples(
    _attributes(
        {}, {"param": WORDS, "ns": SPACES, "subst_value": FLAGS, "command": st.sampled_from(["load", "delete"])}
    ),
    YAML,
).map(lambda parts: _tag("rosparam", *parts))
REMAP = _attributes({"from": _mostly(NAMES, PIECES), "to": _mostly(SPACES, PIECES)}, {}).map(
    lambda attributes: _tag("remap", attributes)
)
ENV = _attributes({"name": NAMES, "value": VALUES}, {}).map(lambda attributes: _tag("env", attributes))
MACHINE = _attributes(
    {"name": FRESH, "address": st.sampled_from(["h", "i"])},
    {
        "default": _mostly(st.sampled_from(["true", "never", "False"]), TEXTS),
        "timeout": _mostly(st.just("5"), TEXTS),
        "user": NAMES,
    },
).map(lambda attributes: _tag("machine", attributes))
NODE = st.tuples(
    _attributes(
        {"pkg": NAMES, "type": NAMES, "name": _mostly(FRESH, PIECES)},
        {
            "ns": SPACES,
            "args": VALUES,
            "output": _mostly(st.sampled_from(["screen", "log"]), TEXTS),
            "respawn": FLAGS,
            "required": FLAGS,
            "machine": _mostly(st.just(""), FRESH),
            "clear_params": FLAGS,
            "respawn_delay": _mostly(st.just("2"), TEXTS),
            "cwd": st.sampled_from(["node", "ros_home"]),
        },
    ),
    st.lists(st.one_of(PARAM, ROSPARAM, REMAP, ENV), max_size=3).map("".join),
).map(lambda parts: _tag("node", *parts))
TEST = st.tuples(
    _attributes(
        {"pkg": NAMES, "type": NAMES, "test-name": NAMES},
        {"name": NAMES, "time-limit": _mostly(st.just("2.5"), TEXTS), "retry": _mostly(st.just("2"), TEXTS)},
    ),
    st.lists(PARAM, max_size=1).map("".join),
).map(lambda parts: _tag("test", *parts))
INCLUDE = st.tuples(
    _attributes(
        {"file": _mostly(st.just("$(dirname)/part.launch"), st.just("$(dirname)/nowhere.launch"))},
        {"ns": SPACES, "pass_all_args": FLAGS, "clear_params": FLAGS},
    ),
    st.lists(st.one_of(PASSED, PASSED, ENV), max_size=2).map("".join),
).map(lambda parts: _tag("include", *parts))
LEAF = st.one_of(ARG, ARG, PARAM, PARAM, ROSPARAM, REMAP, ENV, MACHINE, NODE, NODE, TEST)
GROUP = st.tuples(_attributes({}, {"ns": SPACES}), st.lists(LEAF, max_size=4).map("".join)).map(
    lambda parts: _tag("group", *parts)
)


def _declare(name: str) -> st.SearchStrategy[str]:
    return WORDS.map(lambda text: _tag("arg", {"name": name, "default": text}))


ARGS_FIRST = _mostly(st.permutations(["a", "b", "c", "d"]), st.lists(NAMES, max_size=3, unique=True)).flatmap(
    lambda names: st.tuples(*(_declare(name) for name in names))
)
PART = st.tuples(ARGS_FIRST.map("".join), st.lists(LEAF, max_size=4).map("".join)).map("".join)
MAIN = st.tuples(
    ARGS_FIRST.map("".join), st.lists(st.one_of(LEAF, LEAF, GROUP, INCLUDE), min_size=1, max_size=6).map("".join)
).map("".join)
ARGUMENTS = st.lists(st.tuples(NAMES, st.sampled_from(["1", "x", "true", "$(find corpus_pkg)"])), max_size=2).map(
    lambda pairs: [f"{name}:={value}" for name, value in pairs]
)


@pytest.mark.parametrize(
    "examples",
    [
        200,
        2000,
        pytest.param(5000, marks=pytest.mark.nightly),
    ],
)
def test_generated_files_mean_what_roslaunch_says(
    examples: int, reference: Any, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    load = request.getfixturevalue("load_ours")
    compare = request.getfixturevalue("compare_dumps")
    environment = request.getfixturevalue("base_environment")

    @settings(
        max_examples=examples,
        deadline=None,
        derandomize=examples <= 200,
        database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
    )
    @given(MAIN, PART, ARGUMENTS)
    def agree(main: str, part: str, arguments: list[str]) -> None:
        path = tmp_path / "main.launch"
        path.write_text(f"<launch>\n{main}</launch>\n", encoding="utf-8")
        (tmp_path / "part.launch").write_text(f"<launch>\n{part}</launch>\n", encoding="utf-8")
        found = compare(load([str(path)], arguments, environment), reference.load([str(path)], arguments, environment))
        assert not found, "\n".join(found)

    agree()
