"""Where a value came from, layer by layer, in packages in memory."""

import pytest

from ur.launchfile.query.explain import explain_name, format_layers
from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import UserError

FILES = {
    "/p/main.launch": """<launch>
  <arg name="fast" default="5"/>
  <param name="/talker/rate" value="1"/>
  <include file="/p/part.launch" ns="left">
    <arg name="rate" value="$(arg fast)"/>
  </include>
</launch>
""",
    "/p/part.launch": """<launch>
  <arg name="rate" default="1"/>
  <arg name="word" value="$(eval 'hi' * 2)"/>
  <remap from="chatter" to="words"/>
  <group ns="low">
    <node name="talker" pkg="demo" type="talker">
      <param name="rate" value="$(arg rate)"/>
    </node>
  </group>
  <rosparam file="/p/words.yaml"/>
</launch>
""",
    "/p/words.yaml": "volume: 11\n",
    "/p/all.launch": """<launch>
  <arg name="rate" default="2"/>
  <include file="/p/part.launch" pass_all_args="true"/>
</launch>
""",
    "/p/twice.launch": """<launch>
  <param name="speed" value="1"/>
  <param name="speed" value="2"/>
</launch>
""",
    "/p/broken.launch": "<launch>\n",
}


def explain(name: str, *arguments: str, file: str = "/p/main.launch") -> str:
    return format_layers(explain_name(name, [file], arguments, MemoryWorld(FILES)))


def test_parameter_is_followed_through_includes_to_a_default() -> None:
    assert explain("/left/low/talker/rate") == (
        "parameter /left/low/talker/rate = 5\n"
        '  /p/part.launch:7:7: <param name="rate" value="$(arg rate)"/>\n'
        "    /p/part.launch:2:3: argument rate = '5'\n"
        '      /p/main.launch:5:5: passed by the including file: value="$(arg fast)"\n'
        "        /p/main.launch:2:3: argument fast = '5'\n"
        '          default="5"\n'
        '      /p/part.launch:2:3: default="1" is not used\n'
        '    /p/part.launch:5:3: inside <group ns="low">\n'
        '  /p/main.launch:4:3: included from here, into ns="left"\n'
    )


def test_argument_on_the_command_line_wins_over_its_default() -> None:
    assert explain("fast", "fast:=9") == (
        "/p/main.launch:2:3: argument fast = '9'\n  given: fast:=9\n  /p/main.launch:2:3: default=\"5\" is not used\n"
    )


def test_name_without_namespace_finds_everything_of_that_name() -> None:
    text = explain("rate")
    assert text.count("parameter ") == 2
    assert "parameter /talker/rate = 1" in text
    assert "parameter /left/low/talker/rate = 5" in text
    assert "argument rate = '5'" in text


def test_convenience_argument_shows_its_expression() -> None:
    assert explain("word") == "/p/part.launch:3:3: argument word = 'hihi'\n  value=\"$(eval 'hi' * 2)\"\n"


def test_argument_passed_on_by_pass_all_args_says_so() -> None:
    text = explain("/low/talker/rate", file="/p/all.launch")
    assert "/p/all.launch:3:3: passed on by pass_all_args" in text
    assert "/p/all.launch:2:3: argument rate = '2'" in text


def test_remap_names_the_nodes_it_is_in_force_for() -> None:
    text = explain("chatter")
    assert text.startswith("remap chatter to words\n")
    assert "in force for /left/low/talker" in text


def test_node_shows_its_tag_and_namespace() -> None:
    text = explain("talker")
    assert text.startswith("node /left/low/talker runs talker of package demo\n")
    assert 'inside <group ns="low">' in text


def test_parameter_from_yaml_points_into_the_yaml_file() -> None:
    assert "/p/words.yaml:1:1" in explain("volume")


def test_replaced_value_of_a_parameter_is_shown() -> None:
    text = explain("speed", file="/p/twice.launch")
    assert text.startswith("parameter /speed = 2\n")
    assert "/p/twice.launch:2:3: set to 1 before, and replaced" in text


def test_unknown_name_suggests_a_near_one() -> None:
    with pytest.raises(UserError) as caught:
        explain("volum")
    assert caught.value.diagnostics[0].help == "did you mean volume?"


def test_broken_file_gives_its_own_findings() -> None:
    with pytest.raises(UserError) as caught:
        explain("rate", file="/p/broken.launch")
    assert caught.value.diagnostics[0].rule == "bad-xml"
