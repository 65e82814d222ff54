"""Packages of messages whose classes are imported when they are used."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

from ur_nodes.message_packages import MessageFinder, load_when_used, read_imports

_LOADED = "a message was imported"


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The package `parrot_msgs` with the messages Talk and Walk; the finder is in use."""
    folder = tmp_path / "parrot_msgs/msg"
    folder.mkdir(parents=True)
    (folder.parent / "__init__.py").write_text("")
    (folder / "_talk.py").write_text("class Talk: pass\n")
    (folder / "_walk.py").write_text(f"raise RuntimeError({_LOADED!r})\n")
    (folder / "__init__.py").write_text(
        "from parrot_msgs.msg._talk import Talk  # noqa: F401\nfrom parrot_msgs.msg._walk import Walk  # noqa: F401\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    finders, modules = list(sys.meta_path), set(sys.modules)
    load_when_used()
    yield folder
    sys.meta_path[:] = finders
    for name in set(sys.modules) - modules:
        del sys.modules[name]


@pytest.mark.usefixtures("package")
def test_only_the_message_that_is_used_is_imported() -> None:
    module = import_module("parrot_msgs.msg")
    assert module.Talk is import_module("parrot_msgs.msg._talk").Talk
    assert module.Talk is module.Talk
    with pytest.raises(RuntimeError, match=_LOADED):
        _ = module.Walk


@pytest.mark.usefixtures("package")
def test_package_lists_its_messages_and_has_no_others() -> None:
    module = import_module("parrot_msgs.msg")
    assert dir(module) == module.__all__ == ["Talk", "Walk"]
    with pytest.raises(AttributeError, match=r"module 'parrot_msgs\.msg' has no attribute 'Sing'"):
        _ = module.Sing
    with pytest.raises(ImportError, match="Sing"):
        exec("from parrot_msgs.msg import Sing")


def test_package_with_anything_else_is_loaded_as_it_is(package: Path) -> None:
    (package / "__init__.py").write_text("from parrot_msgs.msg._talk import Talk\nVERSION = 3\n")
    module = import_module("parrot_msgs.msg")
    assert module.VERSION == 3
    assert "parrot_msgs.msg._talk" in sys.modules


@pytest.mark.usefixtures("package")
def test_generator_of_classes_is_an_import_error_that_its_package_expects() -> None:
    with pytest.raises(ImportError):
        import_module("rosidl_generator_py.generate_py_impl")


def test_finder_is_installed_once_and_leaves_other_modules_alone(package: Path) -> None:
    load_when_used()
    assert sum(isinstance(each, MessageFinder) for each in sys.meta_path) == 1
    finder = MessageFinder()
    assert finder.find_spec("parrot_msgs", None) is None
    assert finder.find_spec("parrot_msgs.msg._talk", [str(package)]) is None
    assert finder.find_spec("parrot_msgs.srv", [str(package.parent)]) is None


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", {}),
        ("from ._Bool import *\nfrom ._Byte import *\n", {"Bool": "a.msg._Bool", "Byte": "a.msg._Byte"}),
        ("from a.msg._b import B\n\nfrom a.msg._c import C # noqa\n", {"B": "a.msg._b", "C": "a.msg._c"}),
        ("from .Bool import *\n", None),
        ("import os\n", None),
        ("from a import b as c\n", None),
    ],
)
def test_imports_of_a_package_are_read_only_where_there_is_nothing_else(
    text: str, expected: dict[str, str] | None
) -> None:
    assert read_imports(text, "a.msg") == expected


def test_services_of_ros_1_are_loaded_as_they_are() -> None:
    assert read_imports("from ._Empty import *\n", "a.srv") is None


def test_master_starts_without_the_modules_that_it_does_not_use() -> None:
    folder = Path(__file__).parents[2] / "ubiquity_launches/lib/master_modules"
    program = (
        "import sys, xmlrpc.client, xmlrpc.server, yaml\n"
        "assert not hasattr(xmlrpc.client.http.client, 'HTTPSConnection') and '_ssl' not in sys.modules\n"
        f"assert yaml.__file__.startswith({str(folder)!r}) and not hasattr(xmlrpc.server.pydoc, 'help')"
    )
    subprocess.run([sys.executable, "-c", program], env={"PYTHONPATH": str(folder)}, check=True, timeout=60)
