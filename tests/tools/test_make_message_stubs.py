"""The stubs of ROS messages are those of the definitions that are installed."""

from __future__ import annotations

from pathlib import Path

import pytest
from tools.make_message_stubs import ROS_2, STUBS, find_imports, parse_definition, write_stubs

pytest.importorskip("visualization_msgs.msg")


@pytest.mark.skipif(not ROS_2.is_dir(), reason="ROS 2 is not installed in .ros2")
def test_stubs_are_those_of_the_installed_definitions() -> None:
    written = write_stubs(find_imports())
    assert {name: (STUBS / name).read_text(encoding="utf-8") for name in written} == written


def test_fields_constants_and_arrays_of_a_definition_have_types() -> None:
    text = "\n".join(
        [
            *("uint8 ADD=0 # to put", "Header header", "time[] stamps", "float64[36] covariance", "string<=5 name"),
            *("uint8[] data", "float32[<=3] some", "geometry_msgs/Point[] points", "Own[2] pair"),
        ]
    )
    found = parse_definition(text, "things", "msg")
    assert found.constants == {"ADD": "int"}
    assert found.fields == {
        "header": "std_msgs.msg.Header",
        "stamps": "list[genpy.Time]",
        "covariance": "MutableSequence[float]",
        "name": "str",
        "data": "bytes",
        "some": "Sequence[float]",
        "points": "list[geometry_msgs.msg.Point]",
        "pair": "list[Own]",
    }
    assert found.needs == {("std_msgs", "Header"), ("geometry_msgs", "Point"), ("things", "Own")}


def test_imports_of_messages_are_found(tmp_path: Path) -> None:
    for folder in ("src", "tests", "tools", "bench"):
        (tmp_path / folder).mkdir()
    (tmp_path / "src/a.py").write_text("def f():\n    from nav_msgs.srv import GetMap as Grid\n")
    (tmp_path / "bench/b.py").write_text("from std_msgs.msg import Bool, String\nfrom ur.msg import x\nimport y.msg\n")
    found = find_imports(tmp_path)
    assert found[("nav_msgs", "srv")] == {"GetMap"}
    assert found[("std_msgs", "msg")] == {"Bool", "String"}
