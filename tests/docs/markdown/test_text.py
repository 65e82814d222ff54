"""Markdown that shows what was meant, whatever people write."""

import pytest
from markdown_it import MarkdownIt
from tests.docs.helpers import document, document_one

from ur.docs.markdown.page import MarkdownPage, code, escape_cell, escape_text, inline, render_markdown


@pytest.mark.parametrize("text", ["a", "`", "``a`", "a|b", "<b>", "*x*", "$(arg a)"])
def test_code_shows_its_text(text: str) -> None:
    html = MarkdownIt("commonmark").renderInline(code(text))
    assert html.replace("&lt;", "<").replace("&gt;", ">") == f"<code>{text}</code>"


@pytest.mark.parametrize("text", ["a_b", "_a_", "*a*", "[a](b)", "a|b", "<i>", "`a`", "a\\b", "x__y__z"])
def test_plain_text_stays_plain(text: str) -> None:
    html = MarkdownIt("commonmark").renderInline(escape_text(text))
    assert html.replace("&lt;", "<").replace("&gt;", ">") == text


def test_headings_get_the_anchors_of_github() -> None:
    page = MarkdownPage()
    page.line(f"{page.link_to('x', 'one')} {page.link_to('y', 'two')} {page.link_to('z', 'nowhere')}")
    page.heading(2, "n_amcl.launch.xml", key="one")
    page.heading(2, "N_amcl.launch.xml", key="two")
    assert page.text().splitlines()[0] == "[x](#n_amcllaunchxml) [y](#n_amcllaunchxml-1) `z`"


def test_overview_cannot_break_the_page() -> None:
    overview = "# Big\n\n    code <tag>\n\n```sh\n# kept\nls <file>\n```\n\na <tag> | `b <c>`\n\n```never closed"
    page = render_markdown(document({"launch/one.launch": f"<launch><!--Overview:\n{overview}--></launch>"}))
    assert "\n# Big" not in page
    assert "**Big**" in page
    assert "\n# kept\n" in page
    assert "a &lt;tag> | `b <c>`" in page
    assert page.count("```") % 2 == 0


def test_cells_stay_in_their_column() -> None:
    assert escape_cell("a|b\nc \\| d") == "a\\|b c \\| d"
    assert inline("a\n  <b>") == "a &lt;b>"


def test_arguments_say_kind_default_and_type() -> None:
    doc = document_one("""<launch>
  <arg name="robot_base" doc="From doc."/>
  <arg name="fast" default="true"/><!--fast: From
    a comment.-->
  <arg name="count" default="3"/>
  <arg name="share" default="0.5"/>
  <arg name="map_file" default="$(find my_robot)/map.yaml"/>
  <arg name="twice" value="$(eval 2 * count)"/>
  <arg name="seen"/>
  <param name="a" type="double" value="$(arg seen)"/>
</launch>""")
    rows = [(each.name, each.kind, each.default, each.type, each.doc) for each in doc.arguments]
    assert rows == [
        ("robot_base", "required", "", "base", "From doc."),
        ("fast", "optional", "true", "true or false", "From\na comment."),
        ("count", "optional", "3", "whole number", ""),
        ("share", "optional", "0.5", "number", ""),
        ("map_file", "optional", "$(find my_robot)/map.yaml", "file", ""),
        ("twice", "convenience", "$(eval 2 * count)", "text", ""),
        ("seen", "required", "", "number", ""),
    ]


def test_parameters_belong_to_their_node_or_to_all() -> None:
    doc = document_one("""<launch>
  <param name="all" value="1"/>
  <group ns="g"><param name="in_group" value="2"/>
    <node name="n" pkg="p" type="t">
      <param name="own" value="3"/>
      <rosparam>{gains: {p: 1.5, i: 2}}</rosparam>
      <param name="urdf" command="xacro $(find my_robot)/a.xacro"/>
    </node></group>
</launch>""")
    assert [(p.name, p.values[0].text) for p in doc.params] == [("all", "1"), ("g/in_group", "2")]
    assert [(p.name, p.values[0].text) for p in doc.nodes[0].params] == [
        ("~own", "3"),
        ("~gains/p", "1.5"),
        ("~gains/i", "2"),
        ("~urdf", "what this prints: xacro $(find my_robot)/a.xacro"),
    ]


def test_file_without_words_about_itself_has_a_useful_summary() -> None:
    nodes = "".join(f'<node name="n{i}" pkg="p" type="t"/>' for i in range(6))
    assert document_one(f"<launch>{nodes}</launch>").summary == "Starts `n0`, `n1`, `n2` and 3 more."
    spoken = "<!-- Copyright 2020 Somebody. --><!-- Talks to the wall. And more. --><launch/>"
    assert document_one(spoken).summary == "Talks to the wall."
