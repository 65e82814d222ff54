"""Each substitution and condition has the value that upstream gives it, in Python and in XML."""

from __future__ import annotations

import pytest
from tests.launchfile.ros2.plans import load, load_clean, python, rules, xml

from ur.launchfile.plan.specs import ParameterFile
from ur.source.foreign.yaml_text import load_yaml

SHARE = "/opt/demo/share/demo"
CASES = {  # in Python, in XML, the value
    "text": ("TextSubstitution(text='t')", "t", "t"),
    "concatenation": ("['a', TextSubstitution(text='b'), 'c']", "abc", "abc"),
    "configuration": ("LaunchConfiguration('yes')", "$(var yes)", "true"),
    "configuration with a default": ("LaunchConfiguration('none', default='d')", "$(var none d)", "d"),
    "nested": ("LaunchConfiguration(['y', 'es'])", "$(var $(var name))", "true"),
    "variable": ("EnvironmentVariable('ROBOT')", "$(env ROBOT)", "r2"),
    "variable with a default": ("EnvironmentVariable('NONE', default_value='d')", "$(env NONE d)", "d"),
    "variable that may be missing": ("EnvironmentVariable('NONE', default_value='')", "$(optenv NONE)", ""),
    "share folder": ("FindPackageShare('demo')", "$(find-pkg-share demo)", SHARE),
    "prefix": ("FindPackagePrefix('demo')", "$(find-pkg-prefix demo)", "/opt/demo"),
    "package": ("FindPackage('demo')", "$(find-pkg-prefix demo)", "/opt/demo"),
    "program of a package": ("ExecutableInPackage('e', 'demo')", "$(exec-in-pkg e demo)", "/opt/demo/lib/demo/e"),
    "path": ("PathJoinSubstitution([FindPackageShare('demo'), 'a', ['b', '.c']])",
             "$(path-join $(find-pkg-share demo) a b.c)", f"{SHARE}/a/b.c"),
    "path that is absolute": ("PathJoinSubstitution(['a', '/b'])", "$(path-join a /b)", "/b"),
    "path by division": ("PathSubstitution(FindPackageShare('demo')) / 'a'", "$(path-join $(find-pkg-share demo) a)",
                         f"{SHARE}/a"),
    "joined texts": ("StringJoinSubstitution(['a', 'b'], delimiter='-')", "$(string-join - a b)", "a-b"),
    "content": ("FileContent('/opt/demo/share/demo/text.txt')", "$(file-content /opt/demo/share/demo/text.txt)",
                "content"),
    "this file": ("ThisLaunchFile()", "$(filename)", "/ws/a.launch"),
    "its folder": ("ThisLaunchFileDir()", "$(dirname)", "/ws"),
    "and": ("AndSubstitution('true', LaunchConfiguration('no'))", "$(and true $(var no))", "false"),
    "or": ("OrSubstitution('false', LaunchConfiguration('yes'))", "$(or false $(var yes))", "true"),
    "not": ("NotSubstitution(LaunchConfiguration('no'))", "$(not $(var no))", "true"),
    "all": ("AllSubstitution('true', '1')", "$(all true 1)", "true"),
    "any": ("AnySubstitution('false', '0')", "$(any false 0)", "false"),
    "equal": ("EqualsSubstitution(LaunchConfiguration('yes'), 'true')", "$(equals $(var yes) true)", "true"),
    "equal numbers": ("EqualsSubstitution('1.0', 1)", "$(equals 1.0 1)", "true"),
    "different": ("NotEqualsSubstitution('a', 'b')", "$(not-equals a b)", "true"),
    "choice": ("IfElseSubstitution(LaunchConfiguration('no'), 'a', 'b')", "$(if $(var no) a b)", "b"),
    "choice of nothing": ("IfElseSubstitution('true', if_value='a')", "$(if true a)", "a"),
    "expression": ("PythonExpression(['1 + ', '2'])", "$(eval '1 + 2')", "3"),
    "expression of texts": ("PythonExpression([\"'\", LaunchConfiguration('yes'), \"' == 'true'\"])",
                            "$(eval '\\'$(var yes)\\' == \\'true\\'')", "True"),
    "expression with a module": ("PythonExpression('math.floor(math.pi)', ['math'])",
                                 "$(eval 'math.floor(math.pi)' math)", "3"),
    "flag": ("BooleanSubstitution('1')", "$(not 0)", "true"),
    "anonymous": ("AnonName('n')", "$(anon n)", "n_memory_1"),
}  # fmt: skip
ARGUMENTS = {"yes": "true", "no": "false", "name": "yes"}


@pytest.mark.parametrize(("text", "written", "value"), CASES.values(), ids=CASES)
def test_substitution_has_its_value(text: str, written: str, value: str) -> None:
    declared = [f"DeclareLaunchArgument('{name}', default_value='{word}')" for name, word in ARGUMENTS.items()]
    plan = load_clean(python(*declared, f"ExecuteProcess(cmd=['x', {text}])"))
    assert plan.nodes[0].words[0].removesuffix(".py") == value
    words = "".join(f'<arg name="{name}" default="{word}"/>' for name, word in ARGUMENTS.items())
    command = f'<executable cmd="x"><env name="V" value="{written}"/></executable>'
    plan = load_clean(xml(words + command), "/ws/a.launch.xml")
    assert dict(plan.nodes[0].env)["V"].removesuffix(".xml") == value


CONDITIONS = [
    ("IfCondition('true')", True),
    ("IfCondition('1')", True),
    ("IfCondition('False')", False),
    ("IfCondition(' TRUE ')", True),
    ("UnlessCondition('0')", True),
    ("UnlessCondition(['tr', 'ue'])", False),
    ("IfCondition(PythonExpression('1 < 2'))", True),
    ("LaunchConfigurationEquals('a', 't')", True),
    ("LaunchConfigurationNotEquals('a', 't')", False),
    ("LaunchConfigurationEquals('unknown', None)", True),
    ("LaunchConfigurationNotEquals('unknown', 't')", True),
    ("IfCondition(AndSubstitution(LaunchConfiguration('f'), 'true'))", False),
]


@pytest.mark.parametrize(("condition", "holds"), CONDITIONS)
def test_condition_holds_as_upstream_has_it(condition: str, *, holds: bool) -> None:
    declared = ["DeclareLaunchArgument('a', default_value='t')", "DeclareLaunchArgument('f', default_value='false')"]
    plan = load_clean(python(*declared, f"Node(executable='n', condition={condition})"))
    assert len(plan.nodes) == holds


@pytest.mark.parametrize(
    ("text", "near"), [("yes", "true"), ("off", "false"), ("", "false"), ("maybe", "EqualsSubstitution")]
)
def test_condition_that_is_neither_true_nor_false_is_an_error(text: str, near: str) -> None:
    plan = load(python(f"Node(executable='n', condition=IfCondition('{text}'))", "Node(executable='m')"))
    assert rules(plan) == ["bad-condition"]
    assert near in (plan.diagnostics[0].help or "")
    assert [node.name for node in plan.nodes] == ["m"]


@pytest.mark.parametrize("condition", ["if", "unless"])
@pytest.mark.parametrize("value", ["true", "0", "$(not true)", "$(equals a a)"])
def test_condition_of_xml_and_yaml_agree(condition: str, value: str) -> None:
    first = load_clean(xml(f'<node pkg="" exec="n" {condition}="{value}"/>'), "/ws/a.launch.xml")
    text = f"launch:\n- node: {{pkg: '', exec: n, {condition}: '{value}'}}\n"
    assert len(first.nodes) == len(load_clean(text, "/ws/a.launch.yaml").nodes)
    assert len(first.nodes) == ((value in ("true", "$(equals a a)")) == (condition == "if"))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("Command(['xacro ', '/a.xacro'])", "output of 'xacro /a.xacro'"),
        ("LocalSubstitution('x')", "local"),
        ("FindPackageShare('absent')", "not installed"),
    ],
)
def test_substitution_that_is_known_at_run_time_only_is_a_gap(text: str, reason: str) -> None:
    plan = load(python(f"Node(executable='n', arguments=['a', {text}])", "Node(executable='m')", before=PARAMETER))
    assert [reason in gap.reason for gap in plan.gaps] == [True]
    assert plan.nodes[0].words[0] == "a"
    assert reason in plan.nodes[0].words[1]
    assert [node.name for node in plan.nodes] == ["n", "m"]


PARAMETER = "from launch_ros.substitutions import Parameter"


@pytest.mark.parametrize(
    ("expression", "help_"),
    [
        ("PythonExpression(['true'])", "True"),
        ("PythonExpression([LaunchConfiguration('a'), \" == 'sim'\"])", "quote"),
        ("PythonExpression('1 +')", ""),
        ("PythonExpression('1 / 0')", ""),
        ("PythonExpression('9 ** 9 ** 9')", ""),
    ],
)
def test_expression_that_cannot_be_computed_is_an_error(expression: str, help_: str) -> None:
    plan = load(python("DeclareLaunchArgument('a', default_value='sim')", f"Node(executable={expression})"))
    assert rules(plan) == ["bad-eval"]
    assert help_ in (plan.diagnostics[0].help or "")


def test_expression_that_reads_files_is_not_computed() -> None:
    plan = load(python("Node(executable=PythonExpression(\"__import__('os').system('true')\"))"))
    assert plan.gaps or rules(plan) == ["bad-eval"]


CONFIG = "controller:\n  ros__parameters:\n    rate: 5\n    part: {rate: 6}\n    names: [KEY, b]\n    word: WORD\n"


def _rewritten(call: str) -> dict[str, object]:
    body = f"Node(executable='e', name='controller', parameters=[{call}])"
    plan = load_clean(python(body, before="from nav2_common.launch import *"), files={"/c.yaml": CONFIG})
    return {each.name.removeprefix("/controller/"): each.value for each in plan.params}


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ("'/c.yaml'", {"rate": 5, "part.rate": 6, "names": ["KEY", "b"], "word": "WORD"}),
        (
            "RewrittenYaml(source_file='/c.yaml', param_rewrites={'rate': '7'}, convert_types=True)",
            {"rate": 7, "part.rate": 7, "names": ["KEY", "b"], "word": "WORD"},
        ),
        (
            "RewrittenYaml('/c.yaml', {'controller.ros__parameters.part.rate': '7.5'}, root_key='')",
            {"rate": 5, "part.rate": "7.5", "names": ["KEY", "b"], "word": "WORD"},
        ),
        (
            "RewrittenYaml('/c.yaml', {'controller.ros__parameters.new': 'true', 'other.key': '1'})",
            {"rate": 5, "part.rate": 6, "names": ["KEY", "b"], "word": "WORD", "new": True},
        ),
        (
            "RewrittenYaml('/c.yaml', {}, key_rewrites={'rate': 'hz'}, value_rewrites={'WORD': 'True', 'KEY': 'a'})",
            {"hz": 5, "part.hz": 6, "names": ["a", "b"], "word": True},
        ),
        (
            "ReplaceString(source_file='/c.yaml', replacements={'WORD': ('w', '1'), 'KEY': 'k'})",
            {"rate": 5, "part.rate": 6, "names": ["k", "b"], "word": "w1"},
        ),
        (
            "ReplaceString('/c.yaml', {'WORD': 'w'}, condition=IfCondition('false'))",
            {"rate": 5, "part.rate": 6, "names": ["KEY", "b"], "word": "WORD"},
        ),
        (
            "ReplaceString(RewrittenYaml('/c.yaml', {'rate': '7'}, convert_types=True), {'WORD': 'w'})",
            {"rate": 7, "part.rate": 7, "names": ["KEY", "b"], "word": "w"},
        ),
    ],
)
def test_parameter_file_is_rewritten_as_nav2_does(call: str, expected: dict[str, object]) -> None:
    assert _rewritten(call) == expected


@pytest.mark.parametrize("word", ["WORD", "$(var w)", "é", "a\\\\b", "'7'", "2001-01-01"])
def test_rewritten_text_is_read_as_the_plan_has_it_and_the_file_stays(word: str) -> None:
    call = "ParameterFile(RewrittenYaml('/c.yaml', {'rate': 'true'}), allow_substs=True)"
    nodes = [f"Node(executable='e', name='controller', parameters=[{each}])" for each in (call, call, "'/c.yaml'")]
    text = python("DeclareLaunchArgument('w', default_value='x')", *nodes, before="from nav2_common.launch import *")
    plan = load(text, files={"/c.yaml": CONFIG.replace("WORD", word)})
    sources = [source for node in plan.nodes for source in node.sources]
    assert [isinstance(each, ParameterFile) for each in sources] == [True] * 3
    texts = [str(text) for path, text in plan.written if path in {getattr(each, "path", "") for each in sources}]
    assert [load_yaml(each)["controller"]["ros__parameters"]["rate"] for each in texts] == [True] * 2
    assert not any("$(" in each for each in texts)
    assert {each.name: each.value for each in plan.params}["/controller/rate"] == 5  # the file stays as it is


def test_rewritten_file_may_have_a_namespace_as_its_root() -> None:
    call = "RewrittenYaml('/c.yaml', {}, root_key='ns')"
    body = f"Node(executable='e', name='controller', namespace='ns', parameters=[{call}])"
    plan = load_clean(python(body, before="from nav2_common.launch import *"), files={"/c.yaml": CONFIG})
    assert "/ns/controller/rate" in {each.name for each in plan.params}


@pytest.mark.parametrize(("node", "value"), [("controller", "True"), ("other", "False")])
def test_parameters_of_a_node_are_looked_for(node: str, value: str) -> None:
    body = f"Node(executable=HasNodeParams(source_file='/c.yaml', node_name='{node}'))"
    plan = load_clean(python(body, before="from nav2_common.launch import *"), files={"/c.yaml": CONFIG})
    assert plan.nodes[0].type == value


@pytest.mark.parametrize(("text", "value"), [("on", "True"), ("T", "True"), ("off", "False"), ("anything", "False")])
def test_configuration_is_read_as_a_flag(text: str, value: str) -> None:
    declared = f"DeclareLaunchArgument('a', default_value='{text}')"
    plan = load_clean(
        python(declared, "Node(executable=LaunchConfigAsBool('a'))", before="from nav2_common.launch import *")
    )
    assert plan.nodes[0].type == value


def test_poses_of_several_robots_are_a_gap() -> None:
    plan = load(python("Node(executable=ParseMultiRobotPose('robots'))", before="from nav2_common.launch import *"))
    assert ["poses" in gap.reason for gap in plan.gaps] == [True]


def test_substitutions_in_a_parameter_file_are_performed_where_allowed() -> None:
    files = {"/c.yaml": "/**:\n  ros__parameters:\n    path: $(find-pkg-share demo)/x\n    flag: $(var f)\n"}
    declared = "DeclareLaunchArgument('f', default_value='true')"
    for call, path, flag in (
        ("ParameterFile('/c.yaml', allow_substs=True)", f"{SHARE}/x", True),
        ("ParameterFile('/c.yaml')", "$(find-pkg-share demo)/x", "$(var f)"),
    ):
        plan = load_clean(python(declared, f"Node(executable='e', name='n', parameters=[{call}])"), files=files)
        assert {each.name: each.value for each in plan.params} == {"/n/path": path, "/n/flag": flag}


def test_global_parameter_that_is_not_set_is_a_mistake() -> None:
    plan = load(python("Node(executable='n', arguments=[Parameter('rate')])", before=PARAMETER))
    assert rules(plan, errors=True) == ["undeclared-argument"]


def test_folder_of_the_log_has_a_name_in_each_language_until_the_start() -> None:
    plan = load_clean(python("Node(executable='n', arguments=[PathJoinSubstitution([LaunchLogDir(), 'a'])])"))
    assert plan.nodes[0].words == ("<launch-log-dir>/a",)
    body = xml('<node pkg="" exec="n" args="$(log_dir)/a $(launch_log_dir)"/>')
    assert load_clean(body, "/ws/a.launch.xml").nodes[0].words == ("<launch-log-dir>/a", "<launch-log-dir>")
