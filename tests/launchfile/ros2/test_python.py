"""Python launch files are followed without running them: what computes is known, the rest is a gap."""

from __future__ import annotations

import pytest
from tests.launchfile.ros2.plans import IMPORTS, load, load_clean, parameters, python, rules

_PARAMETER_FILES = "['/opt/demo/share/demo/config/p.yaml']"
KNOWN = {  # statements that set `x`, the text of it
    "function": (
        "def f(a, b=2, *rest, c=3, **more):\n    return a + b + c + len(rest) + len(more)\nx = f(1, 2, 3, d=4)",
        "8",
    ),
    "recursion": ("def f(n):\n    return n * f(n - 1) if n else 1\nx = f(5)", "120"),
    "closure": ("def f():\n    a = 1\n    def g():\n        return a\n    return g\nx = f()()", "1"),
    "lambda": ("x = (lambda a, b=2: a * b)(3)", "6"),
    "loop": ("x = ''\nfor a, b in [(1, 2), (3, 4)]:\n    x += f'{a}{b}'", "1234"),
    "loop with ends": (
        "x = 0\nfor a in range(9):\n    if a == 2:\n        continue\n    if a > 3:\n        break\n    x += a",
        "4",
    ),
    "loop with else": ("for a in []:\n    pass\nelse:\n    x = 1", "1"),
    "while": ("x = 1\nwhile x < 100:\n    x *= 3", "243"),
    "comprehensions": (
        "x = [a for a in range(4) if a % 2] + list({1: 2}.values()) + [*{k: 1 for k in 'a'}]",
        "[1, 3, 2, 'a']",
    ),
    "formatted text": (
        "a = 3.14159\nx = f'{a:.2f} {a!r:>8} {\"b\"}' + '%s-%d' % ('c', 4) + '{}{n}'.format(5, n=6)",
        "3.14  3.14159 bc-456",
    ),
    "text methods": ("x = ' a,b '.strip().upper().replace(',', '-').split('-')", "['A', 'B']"),
    "slices": ("x = 'abcdef'[1:-1:2] + [1, 2, 3][-1:][0].__str__() if False else 'abcdef'[1:-1:2]", "bd"),
    "unpacking": ("a, (b, c) = 1, [2, 3]\nx = [*[a], *(b, c)]", "[1, 2, 3]"),
    "dict": (
        "a = {'b': {'c': 1}}\na['d'] = 2\na.update({'e': 3})\nx = a.get('b', {}).get('c', 0) + a['d'] + len(a)",
        "6",
    ),
    "list changes": ("x = [1]\nx.append(2)\nx.extend([3])\nx += [4]\nx.insert(0, 0)\nx.pop()", "[0, 1, 2, 3]"),
    "boolean": ("x = (1 < 2 <= 2) and not False or None", "True"),
    "choice": ("x = 'a' if 'b' in 'abc' else 'c'", "a"),
    "try": ("try:\n    x = int('a')\nexcept (ValueError, TypeError) as e:\n    x = 'no'\nfinally:\n    y = 1", "no"),
    "try with else": ("try:\n    x = 1\nexcept KeyError:\n    x = 2\nelse:\n    x = 3", "3"),
    "key that is missing": ("try:\n    x = {}['a']\nexcept KeyError:\n    x = 'none'", "none"),
    "raised by the file": ("try:\n    raise ValueError('a')\nexcept ValueError:\n    x = 'caught'", "caught"),
    "package that is missing": (
        "from ament_index_python.packages import PackageNotFoundError, get_package_share_directory as share\n"
        "try:\n    x = share('absent')\nexcept PackageNotFoundError:\n    x = 'none'",
        "none",
    ),
    "class": (
        "class A:\n    n = 2\n    def __init__(self, m):\n        self.m = m\n    def get(self):\n"
        "        return self.n * self.m\n"
        "x = A(3).get()",
        "6",
    ),
    "static method": (
        "class A:\n    n = 2\n    @staticmethod\n    def get(a):\n        return a * A.n\nx = A.get(3) + A().get(1)",
        "8",
    ),
    "environment": (
        "import os\nx = os.environ['ROBOT'] + os.environ.get('NONE', '-') + os.getenv('NONE', '+')",
        "r2-+",
    ),
    "path": ("import os\nx = os.path.join(os.path.dirname('/a/b.c'), os.path.basename('/d/e.f'))", "/a/e.f"),
    "path parts": ("import os\nx = os.path.splitext('/a/b.c')[1] + str(os.path.exists('/nothing'))", ".cFalse"),
    "path of the file": ("import os\nx = os.path.realpath(os.path.join(os.path.dirname(__file__), '..', 'c'))", "/c"),
    "home": ("import os\nx = os.path.expanduser('~/a') + os.path.expandvars('$ROBOT')", "/home/robot/ar2"),
    "pathlib": (
        "from pathlib import Path\nx = str(Path('/a') / 'b.c') + Path('/a/b.c').stem + str(Path('/a/b').parent)",
        "/a/b.cb/a",
    ),
    "share folder": (
        "from ament_index_python.packages import get_package_share_directory as share\nx = share('demo')",
        "/opt/demo/share/demo",
    ),
    "resource of the index": (
        "from ament_index_python.resources import has_resource\nx = has_resource('packages', 'demo')",
        "/opt/demo",
    ),
    "share path": (
        "from ament_index_python import get_package_share_path\nx = get_package_share_path('demo') / 'a'",
        "/opt/demo/share/demo/a",
    ),
    "prefix": ("import ament_index_python.packages as p\nx = p.get_package_prefix('demo')", "/opt/demo"),
    "content": ("with open('/opt/demo/share/demo/text.txt') as f:\n    x = f.read()", "content"),
    "yaml": (
        "import yaml\nx = yaml.safe_load(open('/opt/demo/share/demo/config/p.yaml'))['/**']['ros__parameters']['rate']",
        "5",
    ),
    "json": ("import json\nx = json.loads('{\"a\": [1]}')['a'][0]", "1"),
    "module beside the file": ("from beside import value\nx = value + 1", "8"),
    "module of a package": ("import demo.helper\nx = demo.helper.name('a')", "a!"),
    "name of a package's module": ("from demo.helper import name as n\nx = n('b')", "b!"),
    "annotation": ("x: int = 4", "4"),
    "walrus of types": ("from typing import List\ndef f(a: List[int]) -> str:\n    return str(a)\nx = f([1])", "[1]"),
    "math": ("import math\nx = round(math.pi, 2)", "3.14"),
    "builtins": (
        "x = str(sorted(map(str, [3, 1]))) + str(max(1, 2)) + str(sum([1, 2])) + str(list(zip('a', [1])))",
        "['1', '3']23[('a', 1)]",
    ),
    "isinstance": (
        "x = isinstance('a', str), isinstance(LaunchConfiguration('a'), LaunchConfiguration)",
        "(True, True)",
    ),
    "deletion": ("x = 1\ny = 2\ndel y", "1"),
    "assertion": ("assert True\nx = 1", "1"),
    "text that is evaluated": ("a = 2\nx = eval('a * 3')", "6"),
    "written file": ("with open('/tmp/a.txt', 'w') as f:\n    f.write('b')\nx = open('/tmp/a.txt').read()", "b"),
    "written path": ("from pathlib import Path\np = Path('/tmp/a')\np.write_text('b')\nx = p.read_text()", "b"),
    "written YAML": (
        "import yaml\nyaml.dump({'a': [1]}, open('/tmp/a', 'w'))\nx = yaml.safe_load(open('/tmp/a'))['a']",
        "[1]",
    ),
    "temporary name": ("import tempfile\nx = tempfile.mktemp(prefix='a_', suffix='.sdf')", "/tmp/a_1.sdf"),
    "temporary file": (
        "import tempfile\nwith tempfile.NamedTemporaryFile(mode='w', suffix='.yaml', delete=False) as f:\n"
        "    f.write('b')\nx = open(f.name).read()",
        "b",
    ),
    "files of a pattern": ("from glob import glob\nx = glob('/opt/demo/share/d*/c*/*.yaml')", _PARAMETER_FILES),
    "files of a path": (
        "from pathlib import Path\nx = [str(p) for p in Path('/opt/demo/share/demo').glob('*/*.yaml')]",
        _PARAMETER_FILES,
    ),
    "copy": ("import copy\na = {'b': [1]}\nx = copy.deepcopy(a)\na['b'].append(2)", "{'b': [1]}"),
    "JSON": ("import json\nx = json.dumps({'a': 1})", '{"a": 1}'),
    "sum in a place": ("a = [{'b': 'c'}]\nfor d in a:\n    d['b'] += 'e'\nx = a[0]['b']", "ce"),
    "dataclass": (
        "from dataclasses import dataclass\n@dataclass\nclass A:\n    b: int\n    c: int = 2\nx = A(b=1).c + A(1).b",
        "3",
    ),
    "named tuple": (
        "from typing import NamedTuple\nclass A(NamedTuple):\n    b: str\n    c: str = 'd'\nx = A('a').b + A('a').c",
        "ad",
    ),
    "property": (
        "class A:\n    def __init__(self):\n        self.b = 1\n    @property\n    def c(self):\n        return self.b"
        "\nx = A().c",
        "1",
    ),
    "inherited method": (
        "class A:\n    def b(self):\n        return 'c'\nclass D(A):\n    pass\nx = D().b()",
        "c",
    ),
    "cached function": ("import functools\n@functools.lru_cache(maxsize=None)\ndef f():\n    return 1\nx = f()", "1"),
    "folder of modules": ("import sys\nsys.path.append('/opt/more')\nimport elsewhere\nx = elsewhere.value", "9"),
    "module that is installed": ("import nav.poses\nx = nav.poses.home", "1, 2"),
    "poses of robots": (
        "from nav2_common.launch import ParseMultiRobotPose\nx = ParseMultiRobotPose('robots').value()",
        "{}",
    ),
    "packages": ("from ros2pkg.api import get_package_names\nx = get_package_names()", "['demo', 'launch', 'nav']"),
    "folders of packages": (
        "import ament_index_python.packages as p\nx = p.get_packages_with_prefixes()['nav']",
        "/opt/nav",
    ),
    "exports of a package": (
        "from catkin_pkg.package import parse_package\nx = [e.attributes['path'] for e in "
        "parse_package('/opt/nav/share/nav/package.xml').exports if e.tagname == 'models']",
        "['a/b']",
    ),
    "field of a dataclass": (
        "from dataclasses import dataclass, field\n@dataclass\nclass A:\n    b: list = field(default_factory=list)\n"
        "    c: int = field(default=2)\n    def __post_init__(self):\n        self.b.append(self.c)\n"
        "x = [A().b, A(c=3).b]",
        "[[2], [3]]",
    ),
    "base of a class": (
        "class A:\n    def __init__(self, a):\n        self.a = a\n    def b(self):\n        return self.a\n"
        "class C(A):\n    def __init__(self):\n        super().__init__('c')\n"
        "class D(C):\n    def b(self):\n        return 'd' + super().b()\nx = D().b()",
        "dc",
    ),
    "class method": (
        "class A:\n    def __init__(self, b):\n        self.b = b\n    @classmethod\n    def make(cls, b):\n"
        "        return cls(b + 1)\nclass C(A):\n    pass\nx = C.make(1).b",
        "2",
    ),
    "setter": (
        "class A:\n    @property\n    def b(self):\n        return self._b\n    @b.setter\n    def b(self, c):\n"
        "        self._b = c + 1\na = A()\na.b = 1\nx = a.b",
        "2",
    ),
    "text of an object": ("class A:\n    def __str__(self):\n        return 'b'\nx = f'{A()}' + str(A())", "bb"),
    "exception of the file": (
        "class A(KeyError):\n    pass\ndef f():\n    raise A('b')\ntry:\n    f()\nexcept KeyError:\n    x = 1",
        "1",
    ),
    "assertion that fails": (
        "def f(a):\n    assert a, 'none'\ntry:\n    f([])\nexcept AssertionError as e:\n    x = e",
        "none",
    ),
    "named expression": ("x = [b, 0][0] if (b := {'a': 1}.get('a')) else 2", "1"),
    "pattern": ("import re\nx = re.compile('^(.*)_a.yaml$').search('b_a.yaml').groups()[0]", "b"),
    "utilities": (
        "from launch.utilities import normalize_to_list_of_substitutions as n, perform_substitutions as p\n"
        "x = p(LaunchContext(), n('a'))",
        "a",
    ),
    "generator": (
        "def f(n):\n    for i in range(n):\n        yield i\n    yield from [7, 8]\ndef g():\n    return\n    yield\n"
        "x = [*f(2), *g(), dict([(a, a) for a in f(1)])]",
        "[0, 1, 7, 8, {0: 0, 7: 7, 8: 8}]",
    ),
    "kind of a value": (
        "from typing import MutableMapping\nx = [isinstance(a, MutableMapping) for a in ({}, [])]",
        "[True, False]",
    ),
    "generic class": (
        "from typing import Generic, TypeVar\nT = TypeVar('T')\nclass A(Generic[T]):\n    b = 1\n"
        "class C(A[int]):\n    pass\nx = C().b",
        "1",
    ),
    "class and function that are not followed": (
        "import launch_testing\n@launch_testing.post_shutdown_test()\nclass A:\n    pass\n"
        "async def f():\n    pass\nx = 1",
        "1",
    ),
    "module that is relative": ("from demo.inner.user import x", "[7, 'a!', 7]"),
    "module of the API that a workspace has": ("from nav.exposed import x", "1"),
    "nested data": ("x = [{'a': (1, 2)}][0]['a'][1]", "2"),
}
HELPERS = {
    "/opt/more/elsewhere.py": "value = 9\n",
    "/opt/nav/lib/python3.12/site-packages/nav/poses.py": "home = '1, 2'\n",
    "/opt/nav/share/nav/package.xml": "<package><export><models path='a/b'/></export></package>",
    "/ws/beside.py": "value = 7\n",
    "/opt/demo/share/demo/demo/helper.py": "def name(a):\n    return a + '!'\n",
    "/opt/demo/share/demo/demo/__init__.py": "",
    "/opt/demo/share/demo/demo/inner/__init__.py": "from . import own\nvalue = own.value\n",
    "/opt/demo/share/demo/demo/inner/own.py": "value = 7\n",
    "/opt/demo/share/demo/demo/inner/user.py": "from ..helper import name\nfrom .own import value\n"
    "from . import value as same\nx = [value, name('a'), same]\n",
    "/opt/nav/lib/python3.12/site-packages/nav/exposed.py": "from launch.frontend import expose_action\nx = 1\n",
    "/opt/launch/share/launch/launch/frontend/__init__.py": "from . import nothing\nraise RuntimeError\n",
}


def _known(statements: str) -> str:
    plan = load_clean(python("ExecuteProcess(cmd=['x', str(x)])", before=statements), files=HELPERS)
    return plan.nodes[0].words[0]


@pytest.mark.parametrize(("statements", "text"), KNOWN.values(), ids=KNOWN)
def test_statement_is_followed(statements: str, text: str) -> None:
    assert _known(statements) == text


UNKNOWN = {  # statements after which `x` is not known
    "module": "import numpy\nx = numpy.zeros(3)",
    "name of a module": "from somewhere import x",
    "program": "import subprocess\nx = subprocess.check_output(['ls'])",
    "socket": "import socket\nx = socket.gethostname()",
    "time": "import time\nx = time.time()",
    "random": "import random\nx = random.random()",
    "branch": "import time\nif time.time() > 5:\n    x = 1\nelse:\n    x = 2",
    "loop": "import time\nx = 0\nfor i in range(int(time.time())):\n    x += 1",
    "function": "import time\ndef f():\n    if time.time():\n        return 1\n    return 2\nx = f()",
    "what depends on it": "import time\na = time.time()\nx = [a][0] + 1",
    "text of a substitution": "x = f\"{LaunchConfiguration('a')}\"",
    "sum of a substitution": "x = 'a' + LaunchConfiguration('a')",
    "try": "try:\n    import numpy\n    numpy.zeros(3)\n    x = 1\nexcept ImportError:\n    x = 2",
    "builtin": "x = compile('1', '', 'eval')",
    "import by name": "x = __import__('os')",
    "written file": "x = open('/tmp/a', 'w')",
    "assertion that fails": "def f():\n    assert 0\n    return 1\nx = f()",
    "object": "import time\nclass A:\n    def __init__(self):\n        self.b = 1\n        if time.time():\n"
    "            self.c()\n    def c(self):\n        self.b = 2\nx = A().b",
    "attribute": "import time\nclass A:\n    def __init__(self):\n        self.b = 1\n        if time.time():\n"
    "            self.b = 2\nx = A().b",
    "text of an object": "class A:\n    pass\nx = f'{A()}'",
    "generator": "import time\ndef f():\n    for a in range(int(time.time())):\n        yield a\nx = list(f())[0]",
    "pattern of repeats": "import re\nx = re.match('(a+)+$', 'aab')",
}


@pytest.mark.parametrize("statements", UNKNOWN.values(), ids=UNKNOWN)
def test_what_is_not_known_is_a_gap_and_hides_nothing_else(statements: str) -> None:
    actions = ["Node(executable='before')", "Node(executable='n', arguments=['a', x])", "Node(executable='after')"]
    plan = load(python(*actions, before=statements))
    assert plan.gaps
    assert [node.name for node in plan.nodes] == ["before", "n", "after"]
    assert plan.nodes[1].words[0] == "a"
    assert all(gap.origin is not None for gap in plan.gaps)


def test_branch_that_is_not_known_hides_only_what_it_adds() -> None:
    text = (
        f"{IMPORTS}\nimport time\ndef generate_launch_description():\n    d = LaunchDescription()\n"
        "    d.add_action(Node(executable='a'))\n    if time.time() > 5:\n        d.add_action(Node(executable='b'))\n"
        "    d.add_entity(Node(executable='c'))\n    return d\n"
    )
    plan = load(text)
    assert [node.name for node in plan.nodes] == ["a", "c"]
    assert ["time.time" in gap.reason for gap in plan.gaps] == [True]


def test_condition_that_is_not_known_is_a_gap() -> None:
    plan = load(python("Node(executable='n', condition=IfCondition(Command('date')))", "Node(executable='m')"))
    assert [node.name for node in plan.nodes] == ["m"]
    assert ["whether Node takes part" in gap.reason for gap in plan.gaps] == [True]


def test_include_that_is_not_known_is_a_gap() -> None:
    plan = load(python("IncludeLaunchDescription(Command('ls'))", "Node(executable='m')"))
    assert [node.name for node in plan.nodes] == ["m"]
    assert ["what this include starts" in gap.reason for gap in plan.gaps] == [True]


def test_class_may_be_a_substitution() -> None:
    before = (
        "class Twice(Substitution):\n    def __init__(self, a):\n        super().__init__()\n        self.a = a\n"
        "    def perform(self, context):\n        return self.a.perform(context) * 2"
    )
    actions = ["DeclareLaunchArgument('a', default_value='b')", "Node(executable=Twice(LaunchConfiguration('a')))"]
    assert load_clean(python(*actions, before=before)).nodes[0].type == "bb"


def test_substitution_of_the_file_may_be_exposed_and_return_another() -> None:
    before = (
        "from launch.frontend import expose_substitution\n@expose_substitution('a')\nclass A(Substitution):\n"
        "    def __init__(self, name):\n        super().__init__()\n        self.__name = name\n"
        "    def perform(self, context):\n        return EnvironmentVariable(self.__name)"
    )
    assert load_clean(python("Node(executable='n', arguments=[A('ROBOT')])", before=before)).nodes[0].words == ("r2",)


def test_class_may_be_an_action_with_other_arguments() -> None:
    before = (
        "class Flag(DeclareLaunchArgument):\n    def __init__(self, name, *, default_value=False, **more):\n"
        "        super().__init__(name, default_value=str(default_value), choices=['True', 'False'], **more)"
    )
    actions = ["Flag('a', default_value=True, description='b')", "Node(executable=LaunchConfiguration('a'))"]
    assert load_clean(python(*actions, before=before)).nodes[0].type == "True"
    assert rules(load(python(*actions, before=before), arguments=["a:=1"])) == ["bad-choice"]


def test_argument_of_an_include_may_use_those_before_it() -> None:
    inner = python(
        "DeclareLaunchArgument('a')", "DeclareLaunchArgument('b')", "Node(executable=LaunchConfiguration('b'))"
    )
    include = (
        "IncludeLaunchDescription('/ws/b.launch.py', launch_arguments=[('a', 'x'), ('b', LaunchConfiguration('a'))])"
    )
    files = {"/ws/b.launch.py": inner}
    assert load_clean(python(include), files=files).nodes[0].type == "x"


def test_template_that_is_included_twice_declares_its_arguments_once() -> None:
    files = {"/ws/b.launch.py.in": python("DeclareLaunchArgument('v', default_value='@VERSION@')")}
    plan = load(python(*["IncludeLaunchDescription('/ws/b.launch.py.in')"] * 2), files=files)
    assert not rules(plan)


def test_file_that_is_rewritten_in_a_context_of_its_own_is_known() -> None:
    before = "from launch import LaunchContext\nfrom nav2_common.launch import RewrittenYaml"
    text = "RewrittenYaml(source_file='/opt/demo/share/demo/config/p.yaml', param_rewrites={'rate': '6'})"
    node = f"Node(executable='e', name='n', parameters=[{text}.perform(LaunchContext())])"
    assert parameters(load_clean(python(node, before=before)))["rate"] == "6"


def test_opaque_function_reads_and_changes_the_context() -> None:
    before = (
        "def make(context, *args, **kwargs):\n    context.launch_configurations['b'] = 'set'\n"
        "    a = context.launch_configurations['a']\n    c = context.perform_substitution(LaunchConfiguration('a'))\n"
        "    return [Node(executable=a + c, arguments=list(args) + [kwargs['k']])]"
    )
    actions = [
        "DeclareLaunchArgument('a', default_value='x')",
        "OpaqueFunction(function=make, args=['p'], kwargs={'k': 'q'})",
    ]
    plan = load_clean(python(*actions, "Node(executable=LaunchConfiguration('b'))", before=before))
    assert [(node.type, node.words) for node in plan.nodes] == [("xx", ("p", "q")), ("set", ())]


def test_opaque_function_that_raises_is_a_gap() -> None:
    plan = load(
        python("OpaqueFunction(function=f)", "Node(executable='m')", before="def f(context):\n    return 1 / 0")
    )
    assert [node.name for node in plan.nodes] == ["m"]
    assert plan.gaps


def test_xacro_as_a_library_is_known_up_to_its_output() -> None:
    before = "import xacro\nx = xacro.process_file('/a.xacro', mappings={'b': '1'}).toxml()"
    plan = load(python("Node(executable='n', parameters=[{'robot_description': x}])", before=before))
    assert ["output of 'xacro /a.xacro b:=1'" in gap.reason for gap in plan.gaps] == [True]


def test_line_and_column_of_a_keyword_are_known() -> None:
    text = python("Node(executable='n', namé='é', colour='red')")
    found = [each for each in load(text).diagnostics if each.subject == "colour"]
    assert found[0].span is not None
    line = text[: text.index("colour")].count("\n") + 1
    assert found[0].span.position == (line, text.splitlines()[line - 1].index("colour") + 1)
    assert found[0].span.text == "colour"


@pytest.mark.parametrize(
    ("action", "marked"),
    [
        ("Node(executable='n', name='a b')", "'a b'"),
        ("Node(executable='n', condition=IfCondition('perhaps'))", "'perhaps'"),
        ("Node(executable='n', parameters=['/no.yaml'])", "['/no.yaml']"),
        ("Node(executable=LaunchConfiguration('no'))", "'no'"),
        ("IncludeLaunchDescription(PythonLaunchDescriptionSource('/no.py'))", "'/no.py'"),
        ("DeclareLaunchArgument('no')", "'no'"),
        ("Node(executable=undefined)", "undefined"),
    ],
)
def test_finding_is_at_the_value_that_is_wrong(action: str, marked: str) -> None:
    found = load(python("LogInfo(msg='a')", action)).diagnostics[0]
    assert found.span is not None
    assert found.span.text == marked


@pytest.mark.parametrize(
    ("body", "marked"),
    [
        ('<node pkg="p" exec="n" colour="red"/>', "colour"),
        ('<node pkg="p" exec="n" name="a b"/>', "a b"),
        ('<node pkg="p" exec="n" if="perhaps"/>', "perhaps"),
        ('<node pkg="p" exec="x $(var no)"/>', "$(var no)"),
        ('<include file="/no.xml"/>', "/no.xml"),
    ],
)
def test_finding_in_xml_is_at_the_value_that_is_wrong(body: str, marked: str) -> None:
    found = load(f"<launch>\n  {body}\n</launch>", "/ws/a.launch.xml").diagnostics[0]
    assert found.span is not None
    assert (found.span.text, found.span.position.line) == (marked, 2)


@pytest.mark.parametrize(
    ("statement", "rule", "help_"),
    [
        ("from launch.actions import Noode", "launch-import", ""),
        ("from launch.actions import Node", "launch-import", "launch_ros.actions"),
        ("from launch_ros.actions import PushRosNamespce", "launch-import", "PushRosNamespace"),
    ],
)
def test_import_that_the_api_does_not_have_is_an_error(statement: str, rule: str, help_: str) -> None:
    plan = load(statement + "\n" + python("ExecuteProcess(cmd=['a'])"))
    assert rules(plan) == [rule]
    assert help_ in (plan.diagnostics[0].help or "")


def test_variable_that_is_not_set_is_reported_at_its_place() -> None:
    plan = load(python("Node(executable='n')", before="import os\nx = os.environ['NONE']"))
    (found,) = plan.diagnostics
    assert (found.rule, found.span is not None and found.span.text) == ("unset-variable", "os.environ['NONE']")
