"""`ur lsp` as an editor uses it: a process, the protocol, and a workspace on the disk."""

from pathlib import Path

import pytest

pytest.importorskip("pygls", reason="pygls is not installed: requirements/lsp.lock")

from lsprotocol import types
from tests.lsp.client import open_editor

BRINGUP = """<launch>
  <arg name="robot" default="bob"/>
  <!--robot: The robot's name.-->
  <include file="$(find my_robot)/launch/part.launch.xml">
    <arg name="speed" value="0.5"/>
  </include>
  <node name="talker" pkg="my_robot" type="talk" args="$(arg robot)"/>
</launch>
"""
PART = """<launch>
  <!--Summary: Sets the speed.-->
  <arg name="speed"/>
  <!--speed: How fast it drives, in m/s.-->
  <param name="speed" value="$(arg speed)"/>
</launch>
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "my_robot"
    (folder / "launch").mkdir(parents=True)
    (folder / "scripts").mkdir()
    (folder / "package.xml").write_text("<package><name>my_robot</name></package>")
    (folder / "launch/bringup.launch").write_text(BRINGUP)
    (folder / "launch/part.launch.xml").write_text(PART)
    program = folder / "scripts/talk"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    return folder


@pytest.mark.parametrize("inside", [True, False], ids=["inside", "process"])
async def test_server_answers_an_editor_from_start_to_end(package: Path, *, inside: bool) -> None:
    name = "launch/bringup.launch"
    async with open_editor(package, inside=inside) as editor:
        editor.open(name)
        editor.replace(name, "$(arg robot)", "$(arg robt)")
        (found,) = await editor.wait_for(name, ["undeclared-argument"])
        assert found.range.start == editor.at(name, "$(arg robt)")
        editor.replace(name, "$(arg robt)", "$(arg robot)")
        await editor.wait_for(name, [])
        editor.replace(name, '"speed"', '"sped"')
        await editor.wait_for(name, ["missing-argument", "unknown-argument"])
        editor.replace(name, '"sped"', '"speed"')
        await editor.wait_for(name, [])

        client = editor.client
        document = editor.document(name)
        hover = await client.text_document_hover_async(types.HoverParams(document, editor.at(name, "arg robot)", 5)))
        assert hover is not None
        assert isinstance(hover.contents, types.MarkupContent)
        assert "The robot's name." in hover.contents.value
        assert "`bob`" in hover.contents.value
        found_at = await client.text_document_definition_async(
            types.DefinitionParams(document, editor.at(name, "part.launch.xml"))
        )
        assert isinstance(found_at, list)
        assert [each.uri for each in found_at if isinstance(each, types.Location)] == [
            editor.uri("launch/part.launch.xml")
        ]
        places = await client.text_document_references_async(
            types.ReferenceParams(types.ReferenceContext(True), document, editor.at(name, '"speed"', 1))
        )
        assert places is not None
        assert {(each.uri.rpartition("/")[2], each.range.start.line) for each in places} == {
            ("part.launch.xml", 2),
            ("part.launch.xml", 3),
            ("part.launch.xml", 4),
            ("bringup.launch", 4),
        }
        offered = await client.text_document_completion_async(
            types.CompletionParams(document, editor.at(name, "$(arg robot)", 6))
        )
        assert isinstance(offered, list)
        assert [each.label for each in offered] == ["robot"]
        symbols = await client.text_document_document_symbol_async(types.DocumentSymbolParams(document))
        assert symbols is not None
        assert [each.name for each in symbols] == ["robot", "$(find my_robot)/launch/part.launch.xml", "talker"]
        edits = await client.text_document_formatting_async(
            types.DocumentFormattingParams(document, types.FormattingOptions(2, True))
        )
        assert edits is not None
        assert [line for line in edits[0].new_text.splitlines() if line not in BRINGUP.splitlines()] == [
            '  <node args="$(arg robot)" name="talker" pkg="my_robot" type="talk"/>'
        ]
        editor.replace(name, 'pkg="my_robot" ', 'pkg="my_robot" output="scren" ')
        await editor.wait_for(name, ["bad-choice"])
        place = editor.at(name, "scren")
        actions = await client.text_document_code_action_async(
            types.CodeActionParams(document, types.Range(place, place), types.CodeActionContext([]))
        )
        assert actions is not None
        assert [each.title for each in actions] == ["Change to 'screen'", "Hide 'bad-choice' here"]


async def test_server_renames_marks_and_follows_includes(package: Path) -> None:
    name = "launch/bringup.launch"
    async with open_editor(package, inside=True) as editor:
        editor.open(name)
        editor.open("launch/part.launch.xml")
        client, document = editor.client, editor.document(name)
        edit = await client.text_document_rename_async(
            types.RenameParams(document, editor.at(name, '"speed"', 1), "velocity")
        )
        assert edit is not None
        assert edit.changes is not None
        assert {uri.rpartition("/")[2]: len(edits) for uri, edits in edit.changes.items()} == {
            "bringup.launch": 1,
            "part.launch.xml": 3,
        }
        whole = types.Range(types.Position(0, 0), types.Position(99, 0))
        hints = await client.text_document_inlay_hint_async(types.InlayHintParams(document, whole))
        assert hints is not None
        assert [hint.label for hint in hints] == [" = bob"]
        lenses = await client.text_document_code_lens_async(types.CodeLensParams(document))
        assert lenses is not None
        assert [lens.command.title for lens in lenses if lens.command] == ["Check: no findings", "Show graph", "Launch"]
        command = types.ExecuteCommandParams("ur.check", arguments=[editor.uri(name)])
        assert await client.workspace_execute_command_async(command) == "bringup.launch: no findings"
        folds = await client.text_document_folding_range_async(types.FoldingRangeParams(document))
        assert folds is not None
        assert [(fold.start_line, fold.end_line) for fold in folds] == [(0, 6), (3, 4)]
        symbols = await client.workspace_symbol_async(types.WorkspaceSymbolParams("spd"))
        assert symbols is not None
        assert {(each.name, each.location.uri.rpartition("/")[2]) for each in symbols if each.name == "speed"} == {
            ("speed", "part.launch.xml"),
            ("speed", "bringup.launch"),
        }


async def test_server_checks_and_completes_programs_and_yaml_files(package: Path) -> None:
    (package / "bin").mkdir()
    program = package / "bin/ur_talk"
    program.write_text(
        '#!/bin/bash\n##Summary: Say it.\n##Overview: It talks.\nexec ur launch my_robot bringup.launch "$@"\n'
    )
    program.chmod(0o755)
    (package / "params").mkdir()
    (package / "params/one.yaml").write_text("speed: 1.0 # in m/s\n")
    (package / "params/two.yaml").write_text("sp\n")
    async with open_editor(package, inside=True) as editor:
        editor.open("bin/ur_talk")
        editor.replace("bin/ur_talk", "bringup.launch", "bringp.launch")
        await editor.wait_for("bin/ur_talk", ["program-launch-file"])
        editor.replace("bin/ur_talk", "bringp.launch", "bringup.launch")
        await editor.wait_for("bin/ur_talk", [])
        editor.replace("bin/ur_talk", "bringup.launch", "bringup.launch sped:=2")
        (found,) = await editor.wait_for("bin/ur_talk", ["program-launch-file"])
        assert found.range.start == editor.at("bin/ur_talk", "sped:=2")
        name = "params/two.yaml"
        editor.open(name)
        params = types.CompletionParams(editor.document(name), types.Position(0, 2))
        offered = await editor.client.text_document_completion_async(params)
        assert isinstance(offered, list)
        assert [each.label for each in offered] == ["speed"]
        editor.replace(name, "sp\n", "speed: [1.0\n")
        await editor.wait_for(name, ["bad-yaml"])


async def test_hover_is_answered_while_another_file_takes_long(package: Path) -> None:
    for number in range(1, 9):
        include = f'<include file="$(find my_robot)/launch/heavy{number + 1}.launch"/>'
        (package / f"launch/heavy{number}.launch").write_text(f"<launch>{include * 4}</launch>")
    (package / "launch/heavy9.launch").write_text("<launch/>")
    heavy, name = "launch/heavy1.launch", "launch/bringup.launch"
    async with open_editor(package) as editor:
        editor.open(name)
        text = (package / heavy).read_text()
        editor.open(heavy, text.replace("</launch>", '<param name="a" value="$(arg b)"/></launch>'))
        hover = await editor.client.text_document_hover_async(
            types.HoverParams(editor.document(name), editor.at(name, "arg robot)", 5))
        )
        assert hover is not None
        assert editor.uri(heavy) not in editor.published
        editor.replace(heavy, "$(arg b)", "c")
        editor.replace(heavy, 'value="c"', 'value="$(arg d)"')
        (found,) = await editor.wait_for(heavy, ["undeclared-argument"])
        assert "'d'" in found.message
