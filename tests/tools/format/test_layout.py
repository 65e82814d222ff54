"""How one launch file is laid out."""

from textwrap import dedent

import pytest

from ur.launchfile.world.memory import MemoryWorld
from ur.source.diagnostic import UserError
from ur.tools.format.run import Formatted, format_file

PATH = "/p/launch/a.launch"


def format_text(text: str, **files: str) -> Formatted:
    data = dedent(text).lstrip("\n").encode()
    return format_file(PATH, data, MemoryWorld({PATH: data, **{f"/p/{name}": each for name, each in files.items()}}))


def expect(before: str, after: str) -> None:
    expected = dedent(after).lstrip("\n")
    assert format_text(before).text == expected
    assert format_text(expected).text == expected


def test_tags_are_indented_and_attributes_sorted() -> None:
    expect(
        """
        <launch>
        <group ns = "a" if='true'><node type="t"   name="n" pkg="p"></node></group>
        \t<param value="1" name="a"/></launch>
        """,
        """
        <launch>
          <group ns="a" if="true">
            <node name="n" pkg="p" type="t"/>
          </group>
          <param name="a" value="1"/>
        </launch>
        """,
    )


def test_long_tag_gets_a_line_for_each_attribute() -> None:
    expect(
        '<launch><node type="t" name="n" pkg="p" respawn="true" output="screen">'
        '<env name="A" value="1"/></node></launch>',
        """
        <launch>
          <node name="n"
            output="screen"
            pkg="p"
            respawn="true"
            type="t">
            <env name="A" value="1"/>
          </node>
        </launch>
        """,
    )


def test_one_blank_line_stays_and_none_at_the_edges() -> None:
    expect(
        """
        <launch>

          <param name="a" value="1"/>



          <param name="b" value="1"/>

        </launch>
        """,
        """
        <launch>
          <param name="a" value="1"/>

          <param name="b" value="1"/>
        </launch>
        """,
    )


def test_comments_stay_and_their_lines_move_together() -> None:
    expect(
        """
        <?xml version="1.0"?>
        <!-- before -->
        <launch>
            <!-- first
                   second

                third -->
        <param name="a" value="1"/> <!-- beside -->
        <group>
          <!-- inside -->
        </group>
        </launch>
        <!-- after -->
        """,
        """
        <?xml version="1.0"?>
        <!-- before -->
        <launch>
          <!-- first
                 second

              third -->
          <param name="a" value="1"/> <!-- beside -->
          <group>
            <!-- inside -->
          </group>
        </launch>
        <!-- after -->
        """,
    )


def test_text_of_rosparam_keeps_every_character() -> None:
    text = (
        '<launch>\n    <rosparam ns="b"  command="load">\n'
        + "a:\n   b:  [1,\n 2]  \n<![CDATA[c: 1]]></rosparam>\n</launch>\n"
    )
    expected = text.replace('    <rosparam ns="b"  command="load">', '  <rosparam command="load" ns="b">')
    assert format_text(text).text == expected


def test_quotes_and_references_stay_as_they_are_meant() -> None:
    expect(
        """<launch><arg name='a' default='say "hi" &amp; go'/><param name='b' value='it&apos;s'/></launch>""",
        """
        <launch>
          <arg name="a" default='say "hi" &amp; go'/>
          <param name="b" value="it&apos;s"/>
        </launch>
        """,
    )


def test_stray_text_is_kept() -> None:
    expect(
        "<launch>\n# old\n\n<param name='a' value='1'/></launch>",
        '<launch>\n  # old\n\n  <param name="a" value="1"/>\n</launch>\n',
    )


def test_line_ends_of_windows_go() -> None:
    assert format_text('<launch>\r\n  <param name="a" value="1"/>\r\n</launch>\r\n').text.count("\r") == 0


@pytest.mark.parametrize(
    ("data", "rule"),
    [
        (b"<launch><group></launch>", "bad-xml"),
        (b'<?xml version="1.0" encoding="latin-1"?><launch><!-- \xe9 --></launch>', "not-utf-8"),
        (b"<robot/>", "launch-element"),
    ],
)
def test_file_that_cannot_be_read_is_refused(data: bytes, rule: str) -> None:
    with pytest.raises(UserError) as refused:
        format_file(PATH, data, MemoryWorld({PATH: data}))
    assert refused.value.diagnostics[0].rule == rule
