"""Expressions: each form keeps its value for `ros2 launch`, and one that cannot be written there says why."""

import pytest
from tests.tools.convert.ros2_launch import Ros2LaunchReader

from ur.tools.convert.expressions import NotConvertible, Want, convert_expression

FILE = "/src/demo/launch/demo.launch"


def value_of(expression: str, arguments: dict[str, str], want: Want = "any") -> str:
    written = convert_expression(expression, want).replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    text = f'<launch><node pkg="demo" exec="t" name="a" args="{written}"/></launch>'
    (node,) = Ros2LaunchReader({FILE: text}, {"demo": "/src/demo"}).read(FILE, arguments)
    return " ".join(node.args)


@pytest.mark.parametrize(
    ("expression", "arguments", "expected"),
    [
        ("true", {}, "True"),
        ("not false", {}, "True"),
        ("a == true", {"a": "TRUE"}, "True"),
        ("false != a", {"a": "0"}, "False"),
        ("'x' * 3", {}, "xxx"),
        ("'x' * arg('n')", {"n": "2"}, "xx"),
        ("arg('n') * 'x'", {"n": "2"}, "xx"),
        ("-a + 1", {"a": "3"}, "-2"),
        ("float(a) < 2", {"a": "1.5"}, "True"),
        ("int(a) + 1", {"a": "4"}, "5"),
        ("bool(a)", {"a": "False"}, "False"),
        ("len(a)", {"a": "123"}, "3"),
        ("arg('a')[1:3]", {"a": "robot"}, "ob"),
        ("arg('a')[::2]", {"a": "robot"}, "rbt"),
        ("arg('a')[0]", {"a": "robot"}, "r"),
        ("str(a).split(',')[1]", {"a": "x,y"}, "y"),
        ("a in ('x', 'y')", {"a": "z"}, "False"),
        ("dirname() + '/maps'", {}, "/src/demo/launch/maps"),
        ("math.floor(math.pi)", {}, "3"),
        ("math.sqrt(arg('a'))", {"a": "4"}, "2.0"),
        ("sqrt(arg('a')) if env('UR_SIDE') == 'left' else 0", {"a": "9"}, "3.0"),
        ("'%s' % (str(a) + '_' + str(b),)", {"a": "x", "b": "1"}, "x_1"),
        ("0 < a < 3", {"a": "2"}, "True"),
    ],
)
def test_form_of_expression_keeps_its_value(
    monkeypatch: pytest.MonkeyPatch, expression: str, arguments: dict[str, str], expected: str
) -> None:
    monkeypatch.setenv("UR_SIDE", "left")
    assert value_of(expression, arguments) == expected


@pytest.mark.parametrize(("value", "expected"), [("yes", "True"), ("False", "False"), ("0", "False"), ("", "False")])
def test_argument_used_as_a_condition_is_tested_as_roslaunch_does(value: str, expected: str) -> None:
    assert value_of("a and true", {"a": value}, "truth") == expected


def test_sum_of_arguments_is_joined_where_a_text_is_wanted() -> None:
    assert value_of("a + b", {"a": "1", "b": "2"}, "text") == "12"
    assert value_of("a + b", {"a": "1", "b": "2"}, "number") == "3"


def test_anonymous_name_stays_a_substitution() -> None:
    assert convert_expression("anon('eye')") == "$(eval \"'$(anon eye)'\")"


@pytest.mark.parametrize(
    ("expression", "reason", "help_"),
    [
        ("1 +", "not a Python expression", "ur check explains it"),
        ("arg('a b') == 'x'", "the argument name 'a b'", "rename the argument"),
        ("a == '$(x)'", "'$(' in a text of an expression", "leave it out"),
        ("arg('a') == 'x' == 1", "a comparison of a text with a number", "compare texts: str(arg('name')) == '1'"),
        ("(lambda: 1)()", "a call in an expression", "compute it outside of the launch file"),
        ("int(a, base=2)", "a call in an expression", "compute it outside of the launch file"),
        ("load(a)", "the function 'load' in an expression", "compute it outside of the launch file"),
        ("find(a)", "find() of a value that is computed", "write the name: find('name')"),
        ("anon()", "anon() of a value that is computed", "write the name: anon('name')"),
        ("env()", "env() without a name", "write the name: env('NAME')"),
        ("{'a': 1}", "Dict in an expression", "compute it where the arguments are given, and pass the value"),
    ],
)
def test_expression_without_a_counterpart_is_refused_with_its_reason(expression: str, reason: str, help_: str) -> None:
    with pytest.raises(NotConvertible) as problem:
        convert_expression(expression)
    assert (str(problem.value), problem.value.help) == (reason, help_)
