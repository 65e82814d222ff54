"""Descriptions that escape from xacro's filter compute, and do nothing else: no file, program, socket or signal."""

import socket
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from ur.robot.description.expansion import xacro
from ur.robot.description.expansion.xacro import ExpansionBounds, ExpansionComputer, read_description
from ur.robot.description.surroundings import find_surroundings
from ur.source.diagnostic import UserError

pytestmark = pytest.mark.skipif(xacro.find_own() is None, reason="xacro is not installed: requirements/dev.lock")

HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
# Python that a description wants to run. It comes as an argument, so that each escape is one expression.
CODE = """
import os, sys, ctypes
libc = ctypes.CDLL(None)
def attempt(*steps):
    for step in steps:
        try:
            step()
        except BaseException:
            pass
def connect():
    import socket
    socket.create_connection(("127.0.0.1", {port}))
address = (2).to_bytes(2, "little") + ({port}).to_bytes(2, "big") + bytes((127, 0, 0, 1)) + bytes(8)
attempt(
    lambda: open("{mark}", "w"),
    lambda: os.mkdir("{mark}"),
    lambda: os.system("touch {mark}"),
    lambda: libc.system(b"touch {mark}"),
    lambda: libc.open(b"{mark}", 0o101, 0o644),
    lambda: os.symlink("/", "{mark}"),
    lambda: os.posix_spawn("/bin/touch", ["touch", "{mark}"], dict()),
    lambda: os.fork() or os.execv("/bin/touch", ["touch", "{mark}"]),
    lambda: sys.stdout.write(open("{secret}").read()),
    lambda: sys.stdout.write(sys.modules["__main__"]._ask("file", "{secret}")),
    lambda: sys.stdout.write(open("/proc/self/environ").read()),
    connect,
    lambda: libc.connect(libc.socket(2, 1, 0), address, 16),
    lambda: os.kill(os.getppid(), 9),
    lambda: libc.syscall(62, os.getppid(), 9),
)
sys.stdout.write("<!-- it ran -->")
"""
RUN = "['exec'](xacro.arg('code'), xacro.load_yaml.__globals__)"
GLOBALS = f"xacro.load_yaml.__globals__['__builtins__']{RUN}"
SAFE_EVAL = "i.gi_frame.f_back.f_back.f_back"  # the frame of xacro's own function: no name begins with __
FRAMES = f"{SAFE_EVAL}.f_builtins['exec'](xacro.arg('code'), {SAFE_EVAL}.f_globals)"
CLASSES = "[c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close'][0].__init__.__globals__"
LINK = '<link name="${{{}}}"/>'
ESCAPES = {
    "lambda": LINK.format(f"(lambda: {GLOBALS})()"),
    "lambda in a lambda": LINK.format(f"(lambda: (lambda: {GLOBALS})())()"),
    "default of a lambda": LINK.format(f"(lambda f=lambda: {GLOBALS}: f())()"),
    "list comprehension": LINK.format(f"[{GLOBALS} for n in [1]]"),
    "comprehension in a comprehension": LINK.format(f"[[{GLOBALS} for m in [1]] for n in [1]]"),
    "condition of a comprehension": LINK.format(f"[n for n in [1] if {GLOBALS}]"),
    "generator": LINK.format(f"list({GLOBALS} for n in [1])"),
    "frames of a generator": LINK.format(f"(lambda n: [n.append(({FRAMES} for i in n)), list(n[0])])([])"),
    "subclasses": LINK.format(f"(lambda: {CLASSES}['__builtins__']{RUN})()"),
    "system of os": LINK.format(f"(lambda: {CLASSES}['system']('touch ' + xacro.arg('mark')))()"),
    "closure": LINK.format(
        f"(lambda: xacro.message.__closure__[0].cell_contents.__globals__['sys'].modules['builtins'].__dict__{RUN})()"
    ),
    "key of sorted": LINK.format(f"python.sorted([1], key=lambda n: {GLOBALS} or 0)"),
    "map": LINK.format(f"list(map(lambda n: {GLOBALS}, [1]))"),
    "filter": LINK.format(f"list(python.filter(lambda n: {GLOBALS}, [1]))"),
    "class": LINK.format(f"python.type('T', (dict,), dict(keys=lambda own: {GLOBALS}))().keys()"),
    "modules": LINK.format(
        "(lambda: xacro.load_yaml.__globals__['sys'].modules['ctypes']"
        ".CDLL(None).system(('touch ' + xacro.arg('mark')).encode()))()"
    ),
    "property": f'<xacro:property name="p" value="${{(lambda: {GLOBALS})()}}"/><link name="${{p}}"/>',
    "default of a macro": f'<xacro:macro name="m" params="a:=${{[{GLOBALS}for(n)in[1]]}}"/><xacro:m/>',
    "nested macros": f'<xacro:macro name="m" params="a"><xacro:macro name="n" params="b">'
    f'<link name="${{(lambda: {GLOBALS})()}}"/></xacro:macro><xacro:n b="1"/></xacro:macro><xacro:m a="1"/>',
    "name of a called macro": f'<xacro:call macro="${{(lambda: {GLOBALS})()}}"/>',
    "condition": f'<xacro:if value="${{(lambda: {GLOBALS})()}}"><link name="a"/></xacro:if>',
    "name of an included file": f'<xacro:include filename="${{(lambda: {GLOBALS})()}}"/>',
    "comment": f"<!-- xacro:eval-comments --><!-- ${{(lambda: {GLOBALS})()}} --><link name='a'/>",
    "text": f"<link name='a'>${{(lambda: {GLOBALS})()}}</link>",
    "unit of a YAML file": "<link name=\"${xacro.load_yaml('units.yaml')}\"/>",
    "eval": "<xacro:property name='q' value=\"exec(arg('code'), dict())\"/><link name='$(eval ${q})'/>",
}
# These read, and run nothing, with or without confinement.
INLINED = {
    "list comprehension",
    "comprehension in a comprehension",
    "condition of a comprehension",
    "default of a macro",
}
"""Since Python 3.12 a list comprehension is compiled into its expression, whose names xacro's own filter refuses."""
READERS = {
    "load_yaml": "<link name=\"${xacro.load_yaml(xacro.arg('secret'))}\"/>",
    "tags of Python in YAML": "<link name=\"${xacro.load_yaml('tags.yaml')}\"/>",
    "format": "<link name=\"${('%c0.__globals__[os].environ%c' % (123, 125)).format(xacro.load_yaml)}\"/>",
    "include": '<xacro:include filename="$(arg secret)"/>',
    "include of what a process has": '<xacro:include filename="/proc/self/environ"/>',
}


@pytest.fixture
def listener() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as opened:
        opened.setblocking(False)
        yield opened


def expand(folder: Path, body: str, port: int, *, confined: bool = True) -> str:
    """The text that a description becomes, or the reason for which it does not, of a file in a folder of its own."""
    (folder / "in").mkdir()
    path = folder / "in/a.xacro"
    path.write_text(f"{HEAD}{body}</robot>", encoding="utf-8")
    (folder / "secret").write_text("hunter2", encoding="utf-8")
    units = f"a: !degrees \"(lambda: load_yaml.__globals__['__builtins__']{RUN})()\""
    (folder / "in/units.yaml").write_text(units, encoding="utf-8")
    tags = f"a: !!python/object/apply:os.system ['touch {folder}/mark']"
    (folder / "in/tags.yaml").write_text(tags, encoding="utf-8")
    places = {"mark": f"{folder}/mark", "secret": f"{folder}/secret"}
    words = [f"code:={CODE.format(port=port, **places)}", *(f"{name}:={value}" for name, value in places.items())]
    environment = {"PATH": "/usr/bin:/bin", "TOKEN": "hunter2"}
    bounds = ExpansionBounds() if confined else ExpansionBounds(seccomp="libnone.so.0")
    computer = ExpansionComputer(environment, dict, Path("/nonexistent"), lambda _: not confined, bounds)
    try:
        return read_description(path, find_surroundings(path, environment), computer, words).text
    except UserError as problem:
        return str(problem)


@pytest.mark.parametrize("name", [*ESCAPES, *READERS])
def test_escape_from_the_filter_reaches_nothing(tmp_path: Path, listener: socket.socket, name: str) -> None:
    text = expand(tmp_path, {**ESCAPES, **READERS}[name], listener.getsockname()[1])
    assert "hunter2" not in text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["in", "secret"]
    with pytest.raises(BlockingIOError):
        listener.accept()


def test_these_escapes_run_where_nothing_confines_them(
    tmp_path: Path, listener: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    harmless = CODE.partition("    lambda: os.kill")[0] + ")\n"  # without the signals, which would end this test
    monkeypatch.setitem(globals(), "CODE", harmless)
    ran = set()
    for number, name in enumerate(ESCAPES):
        folder = tmp_path / str(number)
        folder.mkdir()
        expand(folder, ESCAPES[name], listener.getsockname()[1], confined=False)
        if (folder / "mark").exists():
            ran.add(name)
    assert ran == set(ESCAPES) - (INLINED if sys.version_info >= (3, 12) else set())
