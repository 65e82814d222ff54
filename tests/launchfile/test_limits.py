"""Hostile and broken input gets a diagnostic: no exception, no hang, no unbounded memory."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur.launchfile.dump import dump_plan
from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.query.arguments import read_arguments
from ur.launchfile.world.memory import MemoryWorld


def _load(files: dict[str, str | bytes] | str | bytes) -> Plan:
    given_files = files if isinstance(files, dict) else {"/main.launch": files}
    return load_plan(["/main.launch"], [], MemoryWorld(given_files, {"pkg": "/pkg"}))


def _rules(plan: Plan) -> set[str]:
    return {found.rule for found in plan.diagnostics}


def _launch(body: str) -> str:
    return f"<launch>{body}</launch>"


def test_entity_bomb_is_refused_before_it_grows() -> None:
    entities = "".join(f'<!ENTITY e{level} "{f"&e{level - 1};" * 10}">' for level in range(1, 30))
    bomb = f'<!DOCTYPE launch [<!ENTITY e0 "boom">{entities}]><launch><param name="a" value="&e29;"/></launch>'
    assert _rules(_load(bomb)) == {"entity-declaration"}


def test_external_entity_is_not_read() -> None:
    text = '<!DOCTYPE launch [<!ENTITY x SYSTEM "file:///etc/passwd">]><launch><rosparam>a: &x;</rosparam></launch>'
    assert _rules(_load(text)) == {"entity-declaration"}


def test_huge_attribute_is_refused() -> None:
    assert _rules(_load(_launch(f'<param name="a" value="{"x" * 2_000_000}"/>'))) == {"attribute-too-long"}


def test_ten_megabytes_in_one_attribute_are_refused() -> None:
    assert _rules(_load(_launch(f'<param name="a" value="{"x" * 10_000_000}"/>'))) == {"file-too-large"}


def test_thousand_deep_includes_end_with_the_place() -> None:
    files: dict[str, str | bytes] = {
        f"/f{level}.launch": _launch(f'<include file="/f{level + 1}.launch"/>') for level in range(1000)
    }
    files["/main.launch"] = _launch('<include file="/f0.launch"/>')
    plan = _load(files)
    assert _rules(plan) == {"include-too-deep"}
    assert plan.diagnostics[0].span is not None
    assert len(plan.diagnostics[0].notes) <= 21


def test_file_that_includes_itself_is_named_and_not_entered_again() -> None:
    plan = _load(_launch('<include file="/main.launch"/>' * 3))
    assert _rules(plan) == {"include-cycle"}
    assert len(plan.includes) < 1000


def test_file_that_includes_itself_is_read_where_its_arguments_end_the_circle() -> None:
    inner = """<arg name="m"/><param name="a" value="1" if="$(eval m == 'ok')"/>
    <include file="/inner.launch" if="$(eval m != 'ok')"><arg name="m" value="$(arg m)"/></include>"""
    given = '<include file="/inner.launch"><arg name="m" value="{}"/></include>'.format
    plan = _load({"/main.launch": _launch(given("no") + given("ok")), "/inner.launch": _launch(inner)})
    assert _rules(plan) == {"include-cycle"}
    assert [param.name for param in plan.params] == ["/a"]


def test_includes_that_double_at_every_level_end() -> None:
    files: dict[str, str | bytes] = {
        f"/f{level}.launch": _launch(f'<include file="/f{level + 1}.launch"/>' * 2) for level in range(60)
    }
    files["/main.launch"] = files["/f0.launch"]
    files["/f60.launch"] = _launch("")
    assert _rules(_load(files)) == {"too-many-includes"}


def test_recursion_that_ends_is_allowed() -> None:
    body = """<arg name="n" default="20"/><group ns="g"><param name="a" value="1"/>
    <include file="/main.launch" if="$(eval n &gt; 0)"><arg name="n" value="$(eval n - 1)"/></include></group>"""
    plan = _load(_launch(body))
    assert not plan.diagnostics
    assert len(plan.params) == 21


def test_arguments_that_double_are_stopped() -> None:
    body = '<arg name="a0" default="xxxxxxxxxx"/>' + "".join(
        f'<arg name="a{level}" default="$(arg a{level - 1})$(arg a{level - 1} )"/>' for level in range(1, 60)
    )
    assert _rules(_load(_launch(body))) == {"value-too-long"}


def test_arguments_of_a_huge_file_are_read_without_comparing_all_with_all() -> None:
    tags = "".join(f'<arg name="a{n}" default="$(arg z)"/>' for n in range(30_000))
    world = MemoryWorld({"/a.launch": f'<launch><arg name="z" default="1"/>{tags}</launch>'})
    assert len(read_arguments("/a.launch", [], world)) == 30_001


def test_deep_elements_are_refused() -> None:
    assert _rules(_load(_launch("<group>" * 5000 + "</group>" * 5000))) == {"nested-too-deep"}


def test_groups_as_deep_as_allowed_do_not_crash() -> None:
    plan = _load(_launch("<group>" * 890 + "</group>" * 890))
    assert _rules(plan) <= {"nested-too-deep"}


def test_many_errors_end_after_a_hundred() -> None:
    many = "".join(f'<param name="p{number}" value="$(arg x{number})"/>' for number in range(500))
    assert len(_load(_launch(many)).diagnostics) == 100


def test_many_warnings_do_not_cut_the_plan_short() -> None:
    plan = _load(_launch('<nod/><param name="a" value="1"/>' * 300 + '<param name="last" value="1"/>'))
    assert len(plan.diagnostics) == 100
    assert plan.params[-1].name == "/last"


@pytest.mark.parametrize(
    "yaml",
    [
        "a0: &a0 {x: 1, y: 1}\n" + "".join(f"a{n}: &a{n} {{x: *a{n - 1}, y: *a{n - 1}}}\n" for n in range(1, 60)),
        "a0: &a0 [x, x]\n" + "".join(f"a{n}: &a{n} [*a{n - 1}, *a{n - 1}]\n" for n in range(1, 60)),
        "a0: &a0 {x: 1}\n" + "".join(f"a{n}: &a{n} {{<<: [*a{n - 1}, *a{n - 1}]}}\n" for n in range(1, 60)),
        "a: &a {b: *a}",
        "a: &a [*a]",
        "[" * 3000,
        "a: rad(10**10**10)",
        "a: !radians __import__('os').system('true')",
    ],
    ids=["mappings", "lists", "merges", "mapping in itself", "list in itself", "brackets", "huge power", "import"],
)
def test_yaml_bomb_is_refused(yaml: str) -> None:
    assert _rules(_load(_launch(f"<rosparam><![CDATA[{yaml}]]></rosparam>"))) == {"bad-yaml"}


@pytest.mark.parametrize(
    "expression",
    [
        "10 ** 10 ** 10",
        "'a' * 10 ** 10",
        "[0] * 10 ** 9",
        "1 << 10 ** 10",
        "factorial(10 ** 7)",
        "'%1000000000d' % 1",
        "'{:1000000000d}'.format(1)",
        "f'{1:1000000000d}'",
        "'a'.ljust(10 ** 10)",
        "('a' * 1000000).replace('a', 'b' * 1000000)",
        "list(range(10 ** 12))",
        "[x for x in range(10 ** 6) for y in range(10 ** 6)]",
        "str([[0] * 1000] * 1000000)",
        "sum([[0] * 1000] * 1000, [])",
        "round(5, -10 ** 9)",
        "(lambda f: f(f))(lambda f: f(f))",
        "(" * 3000 + "1" + ")" * 3000,
        "-" * 19000 + "1",
        "open('/etc/passwd').read()",
        "().mro()",
        "exec('1')",
        "env.func_globals",
        "'{0.real.imag}'.format(1) * 10 ** 10",
        "comb(10 ** 6, 10 ** 5)",
        "pow(10, 10 ** 9)",
        "'a'.join(['b' * 1000000] * 1000)",
        "'a'.expandtabs(10 ** 12) * 2",
        "list(zip(*[range(10)] * 10))",
        "[*range(3)]",
        "(x := 5)",
    ],
)
def test_hostile_expression_is_refused(expression: str) -> None:
    from xml.sax.saxutils import quoteattr

    plan = _load(_launch(f"<param name='a' value={quoteattr(f'$(eval {expression})')}/>"))
    assert _rules(plan) == {"bad-eval"}


def test_folder_and_device_are_no_launch_files() -> None:
    assert _rules(_load(_launch('<include file="/"/><rosparam file="/"/>'))) == {"missing-file"}


FRAGMENTS = st.lists(
    st.sampled_from(
        [
            *(
                "<launch>",
                "</launch>",
                "<node pkg='p' type='t' name='n'>",
                "</node>",
                "<param name='a' ",
                "value='1'/>",
                "/>",
            ),
            *(
                "<rosparam>",
                "</rosparam>",
                "a: [1",
                "<!--",
                "-->",
                "<![CDATA[",
                "]]>",
                "&amp;",
                "&x;",
                "$(arg ",
                "$(eval ",
                ")",
            ),
            *(
                "<group ns='",
                "'>",
                "</group>",
                "<include file='/main.launch'/>",
                "é",
                "\x00",
                "\r\n",
                '"',
                "<?pi",
                "?>",
                "x='",
            ),
            *(
                "<arg name='a' default='$(eval a)'/>",
                "<!DOCTYPE x [",
                "]>",
                "<x:y xmlns:x='z'/>",
                "\ufeff",
                "\t",
                "if='$(arg a)'",
            ),
        ]
    ),
    max_size=25,
).map("".join)


@pytest.mark.parametrize(
    "examples",
    [
        300,
        5_000,
        pytest.param(20_000, marks=pytest.mark.nightly),
    ],
)
def test_any_text_gives_a_plan(examples: int) -> None:
    @settings(max_examples=examples, deadline=None, derandomize=examples <= 300, database=None)
    @given(st.one_of(FRAGMENTS, FRAGMENTS.map(_launch), st.binary(max_size=60), st.text(max_size=60)))
    def survive(content: str | bytes) -> None:
        if isinstance(content, str):
            content = content.encode("utf-8", "surrogatepass")
        plan = _load(content)
        for found in plan.diagnostics:
            assert str(found.span)
        dump_plan(plan, with_origins=True)

    survive()


def test_included_folder_is_answered_with_the_files_in_it() -> None:
    files: dict[str, str | bytes] = {"/launch/drive.launch.xml": _launch("")}
    (found,) = _load(files | {"/main.launch": _launch('<include file="/launch"/>')}).diagnostics
    assert found.rule == "missing-file"
    assert found.help == "it contains drive.launch.xml"
