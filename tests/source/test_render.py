from ur.source import Note, SourceFile, Span, did_you_mean, error, render_human

FILE = SourceFile("x.launch", "<launch>\n\t<nod/>\n</launch>\n")


def test_report_shows_place_line_caret_notes_and_help() -> None:
    found = error(
        "unknown tag", Span(FILE, 10, 14), rule="a-rule", help="write node", notes=(Note("see", Span(FILE, 0, 7)),)
    )
    assert render_human([found]) == (
        "x.launch:2:2: error: unknown tag [a-rule]\n     2 |  <nod/>\n       |  ^^^^\n"
        "  note: x.launch:1:1: see\n  help: write node\n"
    )


def test_report_without_a_place_is_one_line() -> None:
    assert render_human([error("no robot", rule="a-rule")]) == "error: no robot [a-rule]\n"


def test_caret_far_to_the_right_stays_in_view() -> None:
    file = SourceFile("x", "a" * 5000 + "b" + "c" * 5000)
    _, excerpt, caret = render_human([error("here", Span(file, 5000, 5001), rule="r")]).splitlines()
    assert excerpt[caret.index("^")] == "b"
    assert len(excerpt) < 200


def test_suggestion_is_near_or_none() -> None:
    assert did_you_mean("respaen", ["respawn", "required"]) == "respawn"
    assert did_you_mean("NODE", ["node"]) == "node"
    assert did_you_mean("zzz", ["node"]) is None
