from ur_nodes.pictures.feed import explain_silence


def test_error_of_a_publisher_is_the_reason() -> None:
    errors = {"/simulator": "OpenGL is not installed", "/other": "tired"}
    assert explain_silence(["/simulator"], 1, errors) == "/simulator: OpenGL is not installed"


def test_reason_without_an_error_tells_absent_unreachable_and_silent_publishers_apart() -> None:
    assert explain_silence([], 0, {"/other": "tired"}) == "no node publishes it"
    assert explain_silence(["/cam"], 0, {}) == "/cam publishes it, but cannot be reached"
    assert explain_silence(["/cam"], 1, {}) == "/cam publishes it, but sends nothing"
