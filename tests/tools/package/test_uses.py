"""Which packages a launch package uses."""

import pytest

from ur.launchfile.world.memory import MemoryWorld
from ur.source.diagnostic import UserError
from ur.tools.package.uses import find_used_packages

FILES = {
    "/p/package.xml": "<package><name>p</name></package>",
    "/p/a.launch": """<launch>
  <arg name="robot_base"/>
  <arg name="who_pkg" default="of_default"/>
  <arg name="extra" default="false"/>
  <include file="$(find of_include)/x.launch.xml"/>
  <param name="urdf" command="$(find of_command)/make $(arg robot_base)"/>
  <node name="a" pkg="$(arg who_pkg)" type="t"/>
  <node name="b" pkg="of_$(arg robot_base)" type="t"/>
  <node name="c" pkg="of_option" type="t" if="$(arg extra)"/>
  <node name="d" pkg="never" type="t" if="false"/>
  <node name="e" pkg="p" type="t"/>
</launch>""",
    "/p/bases/one/base.yaml": "summary: x\n",
    "/p/bases/two/base.yaml": "summary: x\n",
    "/p/bin/ur_a": '#!/bin/bash\n# ur launch of_comment x\nexec ur launch --screen of_program y.launch "$@"\n',
}


def test_every_package_is_found_for_every_base_and_option() -> None:
    package, used = find_used_packages("/p", MemoryWorld(FILES, {"p": "/p"}, executables=["/p/bin/ur_a"]))
    assert package.name == "p"
    assert set(used) == {
        "of_default", "of_include", "of_command", "of_one", "of_two", "of_option", "of_program",
    }  # fmt: skip
    assert str(used["of_include"]) == "/p/a.launch:5:18"


def test_folder_without_package_is_refused() -> None:
    with pytest.raises(UserError, match=r"no package\.xml"):
        find_used_packages("/p", MemoryWorld({"/p/a.launch": "<launch/>"}))
