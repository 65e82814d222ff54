"""Whatever a file holds, a check ends with findings, and each has a rule with a page."""

import os
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ur.check.catalogue import load_rules
from ur.check.session import check_paths
from ur.check.worlds import make_world
from ur.launchfile.world import MemoryWorld

LAUNCH_TESTS = Path(__file__).parents[1] / "launchfile"
BELONG_TO_THE_COMMAND_LINE = {"bad-argument"}
PIECES = st.sampled_from([
    "<launch>", "</launch>", "<group ", "</group>", "<node ", "<include ", "</include>", "<arg ", "<param ",
    "<rosparam>", "</rosparam>", "<!--ur: ignore ", "-->", "/>", ">", ' name="a"', ' name="$(arg a)"',
    ' if="$(arg a)"', ' unless="0"', ' value="$(eval a"', ' default="$(env B)"', ' file="$(find p)/l/a.launch"',
    ' pkg="p"', ' type="t"', ' ns=""', "a: [", ' respawn="maybe"', "bad-xml: because", "\n", "é", "&", "$(", "\x00",
    ' machine="m"', "<machine ", ' args="-d \'"',
])  # fmt: skip


def test_corpus_of_the_resolver_is_checked_without_a_traceback() -> None:
    known = set(load_rules()) | BELONG_TO_THE_COMMAND_LINE
    folder = str(LAUNCH_TESTS / "corpus")
    report = check_paths([folder], make_world([folder], {**os.environ, "ROS_PACKAGE_PATH": folder}))
    assert {found.rule for found in report.findings} <= known
    assert report.files >= 150


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(PIECES, max_size=30), st.text(max_size=40))
def test_broken_files_give_findings_and_no_exception(pieces: list[str], yaml: str) -> None:
    files: dict[str, str | bytes] = {
        "/p/package.xml": "<package><name>p</name></package>",
        "/p/l/a.launch": "<launch>" + "".join(pieces) + "</launch>",
        "/p/n_x/launch/n_x.launch.xml": "<launch>" + "".join(pieces),
        "/p/params/a.yaml": yaml.encode("utf-8", "surrogatepass"),
        "/p/bin/ur_x": "#!/bin/bash\n" + yaml.encode("utf-8", "replace").decode(),
    }
    report = check_paths(["/p"], MemoryWorld(files, {"p": "/p"}))
    assert all(found.rule in load_rules() for found in report.findings)


def test_devices_pipes_and_yaml_that_its_aliases_multiply_are_findings_with_their_lines(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "maps").mkdir()
    os.mkfifo(tmp_path / "maps" / "pipe")
    (tmp_path / "maps" / "a.yaml").write_text(
        "resolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.6\nfree_thresh: 0.2\nimage: pipe\n"
    )
    bomb = [
        "a0: &a0 [x, x, x, x, x, x, x, x, x, x]",
        *(f"a{n + 1}: &a{n + 1} [{f'*a{n}, ' * 9}*a{n}]" for n in range(7)),
    ]
    (tmp_path / "bomb.yaml").write_text("\n".join(bomb))
    (tmp_path / "a.launch").write_text(
        '<launch>\n<include file="/dev/zero"/>\n<param name="t" textfile="/dev/zero"/>\n'
        '<param name="b" binfile="/dev/zero"/>\n<rosparam file="/dev/zero"/>\n</launch>\n'
    )
    report = check_paths([str(tmp_path)], make_world([str(tmp_path)], os.environ))
    spans = [
        (found.rule, found.span) for found in report.findings if found.rule in ("missing-file", "bad-map", "bad-yaml")
    ]
    places = [
        (rule, span.file.path.rpartition("/")[2], span.file.text.count("\n", 0, span.start) + 1)
        for rule, span in spans
        if span
    ]
    assert sorted(places) == [
        ("bad-map", "a.yaml", 6),
        ("bad-yaml", "bomb.yaml", 1),
        *(("missing-file", "a.launch", line) for line in (2, 3, 4, 5)),
    ]
