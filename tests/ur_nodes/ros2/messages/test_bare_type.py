"""Types that are not installed, as the middleware of Jazzy asks for their parts."""

from __future__ import annotations

from tests.ros2_session import Ros2Session

PROGRAM = """
import ctypes
import rclpy
from ur_nodes.ros2.messages import bare_type

part = bare_type._get_part()
fields = ctypes.addressof(bare_type._find_donor(bare_type._FIELDS))
print(part(7, b"rosidl_typesupport_fastrtps_c"), part(7, b"rosidl_typesupport_introspection_c") == fields)
print(part(7, b"rosidl_typesupport_cpp"))
"""


def test_table_of_a_type_is_itself_and_has_the_fields_of_an_installed_one(session: Ros2Session) -> None:
    done = session.run("-c", PROGRAM, within=60.0)
    assert done.stdout.split() == ["7", "True", "None"], done.stderr
