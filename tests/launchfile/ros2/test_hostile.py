"""Launch files that attack their reader: no effect, an end within the budget, and one clear line."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from resource import RUSAGE_SELF, getrusage

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.launchfile.ros2.plans import load, python, rules, xml

from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.ros2.load import load_ros2
from ur.launchfile.world.memory import MemoryWorld
from ur.launchfile.world.system import SystemWorld

BODY = "def generate_launch_description():\n    return LaunchDescription([{}])\n"
NODE = "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n"
HOSTILE = {
    "endless loop": "while True:\n    pass",
    "endless loop over a list": "a = [1]\nfor b in a:\n    a.append(b)",
    "nested loops": "for a in range(10000):\n    for b in range(10000):\n        for c in range(10000):\n"
    "            x = a",
    "memory by multiplication": "x = 'a' * 10 ** 12",
    "memory by doubling": "x = 'aaaaaaaa'\nfor a in range(64):\n    x = x + x",
    "memory by a list": "x = [0]\nwhile True:\n    x = x + x",
    "memory by extending": "x = [0]\nfor a in range(64):\n    x.extend(x)",
    "memory by a range": "x = list(range(10 ** 12))",
    "memory by formatting": "x = f'{1:>999999999999}'",
    "memory by joining": "x = ('a' * 100000).join(['b'] * 100000)",
    "memory by replacing": "x = ('a' * 100000).replace('a', 'b' * 100000)",
    "huge number": "x = 9 ** 9 ** 9 ** 9",
    "huge shift": "x = 1 << 10 ** 12",
    "huge factorial": "import math\nx = math.factorial(10 ** 9)",
    "deep recursion": "def f(n):\n    return f(n + 1)\nx = f(0)",
    "long function that is called for ever": "def f():\n    return 1\n"
    + "    a = [1, 2, 3, 4]\n" * 5000
    + "while True:\n    f()",
    "recursion of two": "def f():\n    return g() + g()\ndef g():\n    return f() + f()\nx = f()",
    "fans of calls": "def f(n):\n    return f(n - 1) + f(n - 1) if n else 1\nx = f(50)",
    "recursion of a class": "class A:\n    def __init__(self):\n        self.a = A()\nx = A()",
    "list in itself": "a = []\na.append(a)\nx = a == a\ny = str(a)",
    "dict in itself": "a = {}\na['a'] = a\nx = f'{a}'",
    "import": "x = __import__('os').system('touch MARK')",
    "import of os": "import os\nos.system('touch MARK')\nos.remove('KEEP')\nos.makedirs('MARK')",
    "import by name": "import importlib\nimportlib.import_module('os').system('touch MARK')",
    "module beside the file": "import evil",
    "eval": "eval(\"__import__('os').system('touch MARK')\")\nexec(\"open('MARK', 'w')\")",
    "classes": "x = ().__class__.__mro__[1].__subclasses__()",
    "globals of a function": "def f():\n    pass\nx = f.__globals__['__builtins__']",
    "code of a function": "x = (lambda: 0).__code__.replace(co_code=b'')",
    "format of attributes": "x = '{0.__class__.__mro__}'.format(Node)\ny = '{0.__init__.__globals__}'.format('a')",
    "attributes by name": "x = getattr(Node, '__globals__')\nsetattr(Node, 'a', 1)\nvars(Node).clear()",
    "subprocess": "import subprocess\nsubprocess.run(['touch', 'MARK'])\nsubprocess.Popen('touch MARK', shell=True)",
    "eval of itself": 'x = "eval(x)"\neval(x)',
    "eval of an endless loop": "x = eval('[a for a in range(10000) for b in range(10000)]')",
    "eval of memory": "x = eval(\"'a' * 10 ** 12\")",
    "eval of nested brackets": "x = eval('(' * 9000 + ')' * 9000)",
    "overwritten file": "open('MARK', 'w').write('a')\nopen('KEEP', 'w').write('gone')",
    "written file of a path": "from pathlib import Path\nPath('MARK').write_text('a')\nPath('KEEP').unlink()\n"
    "Path('MARK').mkdir()",
    "appended file": "open('KEEP', 'a').write('more')\nopen('KEEP', 'r+').write('more')",
    "temporary file": "import tempfile\nf = tempfile.NamedTemporaryFile('w', dir='MARK', delete=False)\nf.write('a')",
    "memory of a written file": "f = open('MARK', 'w')\nwhile True:\n    f.write('a' * 100000)",
    "written file by yaml": "import yaml\nyaml.dump({'a': 1}, open('MARK', 'w'))",
    "memory by json": "import json\na = [0]\nfor b in range(60):\n    a = [a, a]\nx = json.dumps(a)",
    "memory by a copy": "import copy\na = [0]\nfor b in range(60):\n    a = [a, a]\nx = copy.deepcopy(a)",
    "copy of a list in itself": "import copy\na = []\na.append(a)\nx = copy.deepcopy(a)",
    "files of everything": "import glob\nx = glob.glob('/*/*/*/*/*/*')\ny = glob.glob('/' + '*/' * 5000)",
    "pattern that backtracks": "import glob\nx = glob.glob('/' + 'a*' * 3000 + 'b')",
    "dataclass of itself": "from dataclasses import *\n@dataclass\nclass A:\n    a: object = A()\nx = A(A(A()))",
    "property of itself": "class A:\n    @property\n    def a(self):\n        return self.a\nx = A().a",
    "classes of one another": "class A:\n    pass\nfor a in range(10000):\n    class A(A):\n        b = a\nx = A()",
    "function of an event": "from launch.event_handlers import OnProcessExit\n"
    "from launch.actions import RegisterEventHandler\ndef f(e, c):\n    return [RegisterEventHandler("
    "OnProcessExit(on_exit=f)), RegisterEventHandler(OnProcessExit(on_exit=f))]\n"
    "x = RegisterEventHandler(OnProcessExit(on_exit=f))",
    "folders of modules": "import sys\nsys.path.extend(['/proc/self', '..'] * 10000)\nimport evil\nimport cwd.evil",
    "names of packages": "from ros2pkg.api import get_package_names\nwhile True:\n    x = get_package_names()",
    "pty": "import pty\npty.spawn(['touch', 'MARK'])",
    "socket": "import socket\nsocket.create_connection(('127.0.0.1', 9))",
    "request": "import urllib.request\nurllib.request.urlopen('http://127.0.0.1:9/')",
    "ctypes": "import ctypes\nctypes.CDLL(None).system(b'touch MARK')",
    "pickle": "import pickle\npickle.loads(b\"cos\\nsystem\\n(S'touch MARK'\\ntR.\")",
    "object of YAML": "import yaml\nyaml.unsafe_load(\"!!python/object/apply:os.system ['touch MARK']\")\n"
    "yaml.load('!!python/name:os.system')",
    "written file": "open('MARK', 'w').write('a')\nwith open('MARK', mode='a') as f:\n    f.write('a')",
    "written path": "from pathlib import Path\nPath('MARK').write_text('a')\nPath('MARK').touch()\n"
    "Path('KEEP').unlink()",
    "copied file": "import shutil\nshutil.copy('KEEP', 'MARK')\nshutil.rmtree('.')",
    "file of the system": "x = open('/proc/self/mem', 'rb').read()\ny = open('/dev/zero').read()\n"
    "z = open('/dev/stdin').read()",
    "thread": "import threading\nthreading.Thread(target=print).start()",
    "signal": "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)\nos.fork()",
    "exit": "import sys, os\nsys.exit(3)\nos._exit(3)\nexit()\nraise SystemExit",
    "monkey patch": "Node.__init__ = lambda *a: None\nLaunchDescription.entities = 5\nimport launch\n"
    "launch.actions = None",
    "changed builtins": "import builtins\nbuiltins.open = None\n__builtins__['open'] = None\nprint = 5",
    "environment": "import os\nos.environ['MARK'] = 'a'\nos.putenv('MARK', 'a')\nos.environ.clear()",
    "bomb of YAML": "import yaml\nx = yaml.safe_load('a: &a [x, x]\\n"
    "' + ''.join('b%d: &b%d [*a, *a]\\n' % (i, i) for i in range(9)))",
    "deep YAML": "import yaml\nx = yaml.safe_load('[' * 200000)",
    "regular expression": "import re\nre.match('(a+)+$', 'a' * 50 + 'b')",
    "hook of an object": "class A:\n    def __getattr__(self, name):\n        return A()\n"
    "    def __str__(self):\n        return self\nx = str(A().b)",
    "regular expression of a long text": "import re\nwhile True:\n    re.search('a*a*b', 'a' * 100000)",
    "exceptions in a loop": "for a in range(9999):\n    for b in range(9999):\n        class A(ValueError): pass",
    "base of itself": "class A:\n    def b(self):\n        return super().b()\nclass C(A):\n    def b(self):\n"
    "        return super().b() + self.b()\nx = C().b()",
    "bases of bases": "class A:\n    def b(self):\n        return super().c\nfor a in range(9999):\n    class A(A):\n"
    "        pass\nwhile True:\n    A().b()",
    "setter of itself": "class A:\n    @property\n    def b(self):\n        return 1\n    @b.setter\n"
    "    def b(self, c):\n        self.b = [c, c]\nA().b = 1",
    "fields of fields": "from dataclasses import *\n@dataclass\nclass A:\n    a: object = 1\n"
    "@dataclass\nclass C:\n    a: object = field(default_factory=lambda: [C(), C()])\nx = C()",
    "generator": "def f():\n    while True:\n        yield 1\nx = list(f())",
    "decorator": "def d(f):\n    while True:\n        pass\n@d\ndef g():\n    pass",
    "assertion with an effect": "assert open('MARK', 'w')",
    "comprehension": "x = [a for a in range(10 ** 6) for b in range(10 ** 6)]",
    "endless iterator": "x = list(iter(int, 1))\ny = list(map(str, iter(int, 1)))",
    "sort of texts": "x = sorted(['a' * 100000] * 100000)",
    "lists of lists": "x = [[[0] * 1000] * 1000] * 1000\ny = str(x)",
    "path by doubling": "from pathlib import Path\nx = Path('a' * 4000)\nfor a in range(40):\n    x = x / x",
    "path by joining": "from pathlib import Path\nx = Path('a')\nfor a in range(40):\n    x = Path(x, x).joinpath(x)",
    "parents of a path": "from pathlib import Path\nx = Path('a/' * 100000).parents",
    "path of os": "import os\nx = 'a' * 1000\nfor a in range(40):\n    x = os.path.join(x, x)",
    "slice by doubling": "x = [0] * 1000\nfor a in range(40):\n    x[0:0] = x",
    "removed items": "x = [0] * 900000 + [1]\nwhile True:\n    x.remove(1)\n    x.append(1)",
    "inserted items": "x = [0] * 100000\nwhile True:\n    x.insert(0, 1)",
    "loops that break": "x = range(900000)\nfor a in range(9999):\n    for b in x:\n        break",
    "uneven assignment": "for a in range(9999):\n    b, c = range(900000)",
    "objects in objects": "class A:\n    def __init__(self, a):\n        self.a = self.b = a\nx = A(0)\n"
    "for a in range(40):\n    x = A(x)\ny = str(x)\nz = f'{x}'",
    "defaults of defaults": "def x(): pass\nfor a in range(40):\n    def x(a=x, b=x): pass\ny = str(x)",
    "file that is read again": "for a in range(99999):\n    x = open('BIG').readlines()",
    "folder that is read again": "import os\nwhile True:\n    x = os.listdir('.')\n    y = os.path.exists('.')",
    "statement given up again": "import re\nwhile True:\n    for a in range(9999):\n        if re.x:\n"
    + "".join(f"            b{number} = a\n" for number in range(800)),
    "text that evaluates itself": "x = 'eval(x)'\ny = eval(x)",
    "file that grows": "x = open('MARK', 'w')\nwhile True:\n    x.write('a' * 10000)\n    y = open('MARK').read()",
    "copies of copies": "import copy\nx = [1]\nfor a in range(40):\n    x = [copy.deepcopy(x), copy.deepcopy(x)]",
    "values in values": "x = [LaunchDescription([])]\nfor a in range(40):\n    x = [LaunchDescription(x), *x]",
}
BUDGET = 1_000_000  # units of work, a part of what a file has
MOST_MEMORY = 300_000  # KiB
LIMIT = 20.0  # seconds of processor: far above the budget, far below for ever


EFFECTS = {
    "os": "exec fork forkpty kill mkdir putenv remove rename rmdir system truncate unsetenv",
    "shutil": "copyfile rmtree",
    "socket": "__new__ connect",
}
OTHERS = ("subprocess.Popen", "ctypes.dlopen", "pickle.find_class")
_seen: list[str] | None = None  # the effects of this process, as long as they are watched


def _watch(event: str, arguments: tuple[object, ...]) -> None:
    if _seen is None:
        return
    owner, _, name = event.partition(".")
    if (
        event in OTHERS
        or name in EFFECTS.get(owner, "").split()
        or (event == "open" and set(str(arguments[1] or "")) & set("wax+"))
    ):
        _seen.append(event)


sys.addaudithook(_watch)


@contextmanager
def _watched() -> Iterator[list[str]]:
    global _seen
    seen: list[str] = []
    _seen = seen
    try:
        yield seen
    finally:
        _seen = None


@pytest.mark.parametrize("attack", HOSTILE.values(), ids=HOSTILE)
def test_hostile_file_has_no_effect_and_ends(attack: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    inside = "".join(f"    {line}\n" for line in attack.splitlines())
    files = {
        "BIG": "word word\n" * 100_000,
        "a.launch.py": f"{NODE}{attack}\n{BODY.format('Node(executable=str(x) if 0 else 0)')}",
        "b.launch.py": f"{NODE}def generate_launch_description():\n{inside}    return LaunchDescription([])\n",
        "c.launch.py": f"{NODE}from launch.actions import OpaqueFunction\ndef f(context):\n{inside}    return []\n"
        + BODY.format("OpaqueFunction(function=f)"),
        "evil.py": "open('MARK', 'w').write('a')\n",
        "KEEP": "",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    before, start, memory = dict(os.environ), time.process_time(), getrusage(RUSAGE_SELF).ru_maxrss
    with _watched() as effects:
        plans = [
            load_ros2(str(tmp_path / name), [], SystemWorld({"HOME": "/"}), budget=Budget(BUDGET))
            for name in list(files)[1:4]
        ]
    assert time.process_time() - start < LIMIT
    assert getrusage(RUSAGE_SELF).ru_maxrss - memory < MOST_MEMORY
    assert not effects
    assert dict(os.environ) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(files)
    for plan in plans:
        reasons = [gap.reason for gap in plan.gaps] + [found.message for found in plan.diagnostics]
        assert all(len(reason) < 1000 and "\n" not in reason for reason in reasons), reasons


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("(" * 5000 + ")" * 5000, "/a.launch.py"),
        ("x = " + "-" * 50_000 + "1", "/a.launch.py"),
        ("x = " + "+".join(["1"] * 50_000), "/a.launch.py"),
        ("if 1:\n" + "".join(" " * i + "if 1:\n" for i in range(1, 99)) + " " * 99 + "pass", "/a.launch.py"),
        ("\0", "/a.launch.py"),
        ("\ud800".encode("utf-8", "surrogatepass"), "/a.launch.py"),
        (b"\xff\xfe", "/a.launch.xml"),
        ("<launch>" + "<group>" * 5000 + "</group>" * 5000 + "</launch>", "/a.launch.xml"),
        ('<!DOCTYPE l [<!ENTITY a "aaa"><!ENTITY b "&a;&a;">]><launch>&b;</launch>', "/a.launch.xml"),
        (xml('<node pkg="" exec="' + "$(var " * 5000 + ")" * 5000 + '"/>'), "/a.launch.xml"),
        (xml('<for len="1000000000" name="i"><node pkg="" exec="n"/></for>'), "/a.launch.xml"),
        (xml('<node pkg="" exec="$(eval \'9 ** 9 ** 9\')"/>'), "/a.launch.xml"),
        (xml('<include file="$(filename)"/>' * 5), "/a.launch.xml"),
        ("launch:\n- " + "group:\n  - " * 5 + "[" * 5000, "/a.launch.yaml"),
        ("launch: &a\n- group: *a\n", "/a.launch.yaml"),
        ("a: &a [x, x]\nlaunch:\n- let: {name: *a, value: [*a, *a]}\n- node: {pkg: *a, exec: *a}", "/a.launch.yaml"),
        ("launch:\n- node: 5\n- 7\n- group: {}\n- {}\n- node: [a]\n- [node]\n"
        "- include: {file: {a: 1}}", "/a.launch.yaml"),
    ],
    ids=lambda value: str(value)[:24],
)  # fmt: skip
def test_hostile_text_is_read_to_an_end(text: str | bytes, name: str) -> None:
    start = time.process_time()
    load("", name, {name: text})
    assert time.process_time() - start < LIMIT


NAMES = ["/a.launch.py", "/a.launch.xml", "/a.launch.yaml"]
REPEATED = {
    "doubled text": "*[SetLaunchConfiguration('a', [LaunchConfiguration('a')] * 2) for i in range(60)]",
    "doubled variable": "*[SetEnvironmentVariable('a', [EnvironmentVariable('a')] * 2) for i in range(60)]",
    "doubled path": "*[SetLaunchConfiguration('a', PathJoinSubstitution([LaunchConfiguration('a')] * 2)) for i in x]",
    "groups of groups": "g(60)",
    "texts of texts": "Node(executable=t(60))",
    "lists in an expression": "Node(executable=PythonExpression('[[[1] * 1000] * 1000] * 1000'))",
    "nodes with variables": "*[SetEnvironmentVariable(str(i), 'a') for i in range(999)], *[Node(executable='a')] * 999",
    "scopes with variables": "*[SetEnvironmentVariable(str(i), 'a') for i in range(999)], *[GroupAction([])] * 99999",
    "remappings": "*[SetRemap('a', 'b')] * 99999",
    "long command": "*[Node(executable='a', arguments='a' * 90000)] * 9999",
    "long value": "*[Node(executable='a', parameters=[{'a': [LaunchConfiguration('a'), 'a' * 90000]}])] * 9999",
    "many folders": "SetEnvironmentVariable('PATH', '/:' * 90000), *[Node(executable=FindExecutable('a'))] * 9999",
    "contents of files": "*[Node(executable=FileContent('/big'))] * 99999",
}


@pytest.mark.parametrize("actions", REPEATED.values(), ids=REPEATED)
def test_description_that_grows_is_visited_within_the_budget(actions: str) -> None:
    before = (
        "x = range(60)\ndef g(n):\n    a = GroupAction([])\n    for i in range(n):\n        a = GroupAction([a, a])\n"
        "    return a\ndef t(n):\n    a = ['a']\n    for i in range(n):\n        b = []\n        b.append(a)\n"
        "        b.append(a)\n        a = b\n    return a\n"
    )
    start, memory = time.process_time(), getrusage(RUSAGE_SELF).ru_maxrss
    first = "SetLaunchConfiguration('a', 'a'), SetEnvironmentVariable('a', 'a')"
    files = {"/a.launch.py": python(first, actions, before=before), "/big": "a" * 100_000}
    plan = load_ros2("/a.launch.py", [], MemoryWorld(files), budget=Budget(BUDGET))
    assert time.process_time() - start < LIMIT
    assert getrusage(RUSAGE_SELF).ru_maxrss - memory < MOST_MEMORY
    assert any(" too long to " in text for text in (*map(str, plan.gaps), *map(str, plan.diagnostics)))


def test_poses_of_many_robots_are_read_within_the_budget() -> None:
    text = (
        "from nav2_common.launch import ParseMultiRobotPose\nfor a in range(10000):\n"
        "    x = ParseMultiRobotPose('robots').value()\n"
    )
    start = time.process_time()
    robots = f"robots:={'a={x: 1.0};' * 5000}"
    load_ros2("/a.launch.py", [robots], MemoryWorld({"/a.launch.py": text}), budget=Budget(BUDGET))
    assert time.process_time() - start < LIMIT


@pytest.mark.parametrize("name", NAMES[::2])
def test_file_that_is_too_large_is_not_parsed(name: str) -> None:
    assert rules(load("#" * 600_000, name)) == ["file-too-large"]


@pytest.mark.parametrize(
    "text", ["return", "break", "continue", "def f():\n    break\nx = f()", "class A:\n    return"]
)
def test_statement_outside_of_what_it_ends_is_reported_as_python_does(text: str) -> None:
    assert rules(load(f"{text}\n")) == ["python-syntax"]


def test_entry_that_raises_is_a_gap() -> None:
    plan = load("generate_launch_description = lambda: 1 / 0\n")
    assert [gap.reason for gap in plan.gaps] == ["it raises ZeroDivisionError: division by zero"]


def test_files_that_include_one_another_end() -> None:
    include = "IncludeLaunchDescription('/{}.launch.py')"
    files = {f"/{name}.launch.py": python(*[include.format(other)] * 9) for name, other in ("ab", "ba")}
    plan = load(files["/a.launch.py"], "/a.launch.py", files)
    assert "include-cycle" in rules(plan)


def test_file_that_is_missing_is_one_error() -> None:
    assert rules(load_ros2("/no.launch.py", [], SystemWorld({}))) == ["missing-file"]


TEXT = (
    "launch node group arg let include x y 'a' \"b\" 1 -1 0.5 None True ( ) [ ] { } : , . = == + "
    "- * / % ** @ | & ~ < > "
    "lambda for in if else while def class return yield try: except: finally: with as import from raise del not and or "
    "LaunchDescription Node DeclareLaunchArgument LaunchConfiguration OpaqueFunction IfCondition PythonExpression "
    "perform context ld add_action generate_launch_description() f'{x}' *x **x # \\ \n \n    \n        os.path.join "
    "get_package_share_directory Command parameters= remappings= condition= name= executable= self global assert "
    "async await match case ... := -> $(var $(eval <node </group> pkg= exec= - key:"
)
WORDS = st.sampled_from(TEXT.split(" "))
GOOD = [
    python(
        "DeclareLaunchArgument('a', default_value='1', choices=['1', '2'])",
        "GroupAction([PushRosNamespace('n'), Node(package='demo', executable='e', name='n', "
        "parameters=['/p', {'a': [1]}])])",
        "OpaqueFunction(function=f, args=[x])",
        "RegisterEventHandler(OnProcessExit(target_action=y, on_exit=[TimerAction(period=1.0, actions=[y])]))",
        "ForEach('{a: 1}', function=lambda a: [Node(executable=a)])",
        "SetParameter('a', ParameterValue(LaunchConfiguration('a'), value_type=int))",
        before="import os, yaml\nx = {'a': [os.path.join('a', 'b'), *range(3)]}\ny = Node(executable='y')\n"
        "class A(Substitution):\n    def perform(self, c):\n        return 'a'\n"
        "def f(context, a, *b, c=1):\n    try:\n        return [Node(executable=A()) for i in a if i]\n"
        "    except ValueError as e:\n        raise\n",
    ),
    xml(
        '<arg name="a" default="$(env HOME x)"><choice value="b"/></arg><group if="$(eval \'1 &lt; 2\')">'
        '<push_ros_namespace namespace="$(var a)"/><node pkg="demo" exec="e" args="\'a\' b $(anon c)">'
        '<param name="p"><param name="q" value="[1, 2]" type="list_of_int"/></param><remap from="a" to="b"/>'
        "</node></group>"
        '<for_each values="{a: 1}"><executable cmd="$(for-var a)"/></for_each>'
        '<timer period="1.0"><let name="a" value="b"/></timer>'
    ),
    "launch:\n- arg: {name: a, default: b}\n- group:\n    scoped: false\n    children:\n    - node:\n"
    "        pkg: demo\n"
    "        exec: $(var a)\n        param:\n        - {name: p, value: [1, 2]}\n        - from: /p\n"
    "- node_container: {name: c, namespace: '', pkg: p, exec: e, composable_node: [{pkg: p, plugin: q, name: r}]}\n",
]
SETTINGS = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))


@SETTINGS
@given(st.lists(WORDS, max_size=40).map(" ".join), st.sampled_from(NAMES))
def test_any_text_is_read_without_an_exception(text: str, name: str) -> None:
    load(text, name)
    load(f"from launch import *\ndef generate_launch_description():\n    x = [1]\n    {text}\n    return x", NAMES[0])


@SETTINGS
@given(st.integers(0, 2), st.data())
def test_good_file_that_is_changed_is_read_without_an_exception(number: int, data: st.DataObject) -> None:
    parts = GOOD[number].replace("(", " ( ").replace(",", " , ").split(" ")
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(parts) - 1))
        other = data.draw(st.one_of(WORDS, st.sampled_from(parts), st.just("")))
        parts[place : place + data.draw(st.integers(0, 2))] = [other]
    plan = load(" ".join(parts), NAMES[number])
    assert all(found.message and found.rule for found in plan.diagnostics)
