"""Launch files of ROS 2: the layout of XML and YAML, whose tags and entities stay in their order."""

import pytest

from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import UserError
from ur.tools.format.run import Formatted, format_file


def format_text(path: str, text: str) -> Formatted:
    return format_file(path, text.encode(), MemoryWorld({path: text}))


def test_xml_is_laid_out_and_stays_in_its_order() -> None:
    before = '<launch><let name="q" value="2"/><arg   name="b" default="$(var q)"/><arg name="a"/>'
    before += '<node exec="e" pkg="p"><param name="x" value="1"/></node></launch>'
    assert format_text("/a.launch.xml", before).text == (
        '<launch>\n  <let name="q" value="2"/>\n  <arg name="b" default="$(var q)"/>\n  <arg name="a"/>\n'
        '  <node exec="e" pkg="p">\n    <param name="x" value="1"/>\n  </node>\n</launch>\n'
    )


YAML = """\
launch:

    # how fast


    -   arg:
            name: "speed"   # m/s
            default: '1'
    -   node:
            pkg: p
            exec: e
            param:
            -   name: text
                value: |
                    one
                      two
            -   {name: a, value: 1}

"""
FORMATTED = """\
launch:

  # how fast

  - arg:
      name: "speed"   # m/s
      default: '1'
  - node:
      pkg: p
      exec: e
      param:
      - name: text
        value: |
            one
              two
      - {name: a, value: 1}
"""


def test_yaml_is_laid_out_with_its_comments() -> None:
    done = format_text("/a.launch.yaml", YAML)
    assert done.text == FORMATTED
    assert not format_text("/a.launch.yaml", FORMATTED).changed


def test_yaml_that_would_mean_something_else_stays() -> None:
    done = format_text("/a.launch.yaml", "launch: ['a\tb']\n")
    assert (done.text, done.kept is not None) == (done.before, True)


def test_yaml_with_a_mistake_stays() -> None:
    with pytest.raises(UserError, match="expected YAML"):
        format_text("/a.launch.yaml", "launch: [\n")
