"""Broken and odd repositories are documented as they are, and never end in a traceback."""

from pathlib import Path

import pytest
from tests.docs.helpers import document, document_one, find, walk

from ur.docs.build import build_documents
from ur.docs.markdown.page import render_markdown
from ur.launchfile.world import MemoryWorld, SystemWorld
from ur.source.diagnostic import UserError

CORPUS = Path(__file__).parents[1] / "launchfile" / "corpus"
GOLDEN = Path(__file__).parents[1] / "launchfile" / "golden"


def test_file_that_is_not_well_formed_is_documented_as_broken() -> None:
    doc = document_one('<launch>\n  <arg name="a" default="1"/>\n  <node\n</launch>')
    assert "not well-formed XML" in doc.problems[0]
    assert [argument.name for argument in doc.arguments] == ["a"]
    assert "**Broken:**" in render_markdown(document({"launch/one.launch": "<launch>"}))


def test_missing_include_is_shown_in_the_tree_and_as_a_problem() -> None:
    doc = document_one('<launch><include file="$(find my_robot)/launch/tow.launch"/></launch>')
    assert [item.kind for item in walk(doc.trees[0].root)] == ["file", "missing"]
    assert "launch/tow.launch: no such file" in doc.problems[0]


def test_files_that_include_one_another_end() -> None:
    text = '<launch><include file="$(find my_robot)/launch/{}.launch"/><node name="n" pkg="p" type="t"/></launch>'
    documents = document({"launch/a.launch": text.format("b"), "launch/b.launch": text.format("a")})
    assert [item.kind for item in walk(find(documents, "launch/a.launch").trees[0].root)].count("cycle") == 1
    assert "includes itself" in render_markdown(documents)


def test_argument_that_is_not_declared_is_a_problem_of_the_including_file() -> None:
    doc = document_one(
        '<launch><include file="$(find my_robot)/launch/b.launch"><arg name="x" value="1"/></include></launch>',
        {"launch/b.launch": '<launch><arg name="y" default="2"/></launch>'},
    )
    assert "argument 'x' is passed" in doc.problems[0]


def test_include_that_only_the_user_can_complete_names_what_fits() -> None:
    doc = document_one(
        '<launch><arg name="kind"/><include file="$(find my_robot)/kinds/$(arg kind).launch"/></launch>',
        {"kinds/red.launch": "<launch/>", "kinds/blue.launch": "<launch/>", "kinds/readme.txt": ""},
    )
    assert [(target.name, target.state) for target in doc.includes[0].targets] == [
        ("blue.launch", "candidate"),
        ("red.launch", "candidate"),
    ]
    assert doc.trees[0].root.children[0].name == "$(find my_robot)/kinds/$(arg kind).launch"
    assert doc.problems == ()


def test_node_without_a_name_or_type_is_documented() -> None:
    doc = document_one('<launch><node pkg="p"/><node name="$(arg" pkg="p" type="t"/></launch>')
    assert len(doc.nodes) == 2


def test_folder_without_a_package_is_documented() -> None:
    world = MemoryWorld(
        {
            "/robots/talk.launch": '<launch><node name="talker" pkg="demo" type="talker"/></launch>',
            "/robots/bin/go": "#!/bin/sh\n##Summary: Go.\nroslaunch talk.launch\n",
        }
    )
    (package,) = build_documents("/robots", world).packages
    assert not package.is_package
    assert package.launch_files[0].summary == "Starts `talker`."
    assert package.programs[0].starts == ("talk.launch",)
    assert package.programs[0].command == "bin/go"


def test_folder_of_packages_is_one_page_with_a_part_for_each() -> None:
    launch = '<launch><include file="$(find b)/launch/b.launch"/></launch>'
    world = MemoryWorld(
        {
            "/ws/a/package.xml": "<package><name>a</name></package>",
            "/ws/a/launch/a.launch": launch,
            "/ws/b/package.xml": "<package><name>b</name></package>",
            "/ws/b/launch/b.launch": '<launch><node name="n" pkg="p" type="t"/></launch>',
        }
    )
    documents = build_documents("/ws", world)
    assert [package.name for package in documents.packages] == ["a", "b"]
    page = render_markdown(documents)
    assert "## a\n" in page
    assert "## b\n" in page
    assert [item.name for item in walk(find(documents, "a/launch/a.launch").trees[0].root)] == [
        "a.launch",
        "b.launch",
        "n",
    ]


def test_other_packages_are_named_and_never_looked_into() -> None:
    # What is installed on the computer that makes the documents must not show in them.
    doc = document_one(
        """<launch>
  <include file="$(find roslaunch)/resources/example.launch"><arg name="x" value="1"/></include>
  <node name="n" pkg="p" type="t"><rosparam file="$(find roslaunch)/params.yaml"/></node>
  <param name="home" value="$(env HOME)"/>
</launch>"""
    )
    assert doc.problems == ()
    assert [item.kind for item in walk(doc.trees[0].root)] == ["file", "elsewhere", "node"]
    assert doc.params[0].values[0].text == "$(env ...)"


def test_nothing_to_document_is_an_error_in_one_line() -> None:
    with pytest.raises(UserError, match="holds no launch file"):
        build_documents("/ws", MemoryWorld({"/ws/readme.md": ""}))


@pytest.mark.parametrize("folder", [CORPUS, GOLDEN], ids=lambda path: path.name)
def test_every_broken_file_of_the_corpus_is_documented(folder: Path) -> None:
    documents = build_documents(str(folder), SystemWorld({}))
    assert sum(len(package.launch_files) for package in documents.packages) > 10
    assert str(folder) not in render_markdown(documents)
