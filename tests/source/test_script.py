import pytest

from ur.source.script import explain_script, find_script_faults

INSTALLED = {"python3": "/usr/bin/python3", "/usr/bin/python3": "/usr/bin/python3", "bash": "/bin/bash"}


def faults(data: bytes) -> list[tuple[str, str]]:
    found = find_script_faults("/ws/a b.py", data, lambda name: INSTALLED.get(name, ""))
    return [(data.decode("utf-8", "replace")[each.start : each.end], f"{each.message}: {each.help}") for each in found]


@pytest.mark.parametrize(
    ("data", "place", "words"),
    [
        (b"#!/usr/bin/env python3\r\nprint(1)\r\n", "#!/usr/bin/env python3", r"sed -i 's/\r$//' '/ws/a b.py'"),
        (b"#!/usr/bin/env python\n", "#!/usr/bin/env python", "python3 is: sed -i '1s/python/python3/' '/ws/a b.py'"),
        (b"#! /usr/bin/python2.7\nprint 1\n", "#! /usr/bin/python2.7", "'/usr/bin/python2.7' is not installed"),
        (b"#!/usr/bin/env node\n", "#!/usr/bin/env node", "install node"),
        (b"#!/usr/bin/env python3 -u\n", "#!/usr/bin/env python3 -u", "write '#!/usr/bin/env -S python3 -u'"),
        (b"import os\n", "import os", "write '#!/usr/bin/env python3' as the first line"),
        (b"\xef\xbb\xbf#!/usr/bin/env python3\n", "\ufeff#!/usr/bin/env python3", "remove what is before '#!'"),
        (b"#!/usr/bin/env python3\nx = 1\nprint 'a'\n", "print 'a'", "Python 2: Missing parentheses"),
        (b"#!/usr/bin/env python3\nraise E, 'x'\n", "raise E, 'x'", "converts it (sudo apt-get install 2to3)"),
        (b"#!/usr/bin/python3\ntry:\n  f()\nexcept E, e:\n  pass\n", "except E, e:", "2to3 -w '/ws/a b.py'"),
        (b"#!/usr/bin/python3\nx = `y`\n", "x = `y`", "2to3"),
    ],
)  # fmt: skip
def test_fault_of_a_script_is_named_at_its_place(data: bytes, place: str, words: str) -> None:
    ((where, text),) = faults(data)
    assert where == place
    assert words in text


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x7fELF\x02\x01",
        b"#!/usr/bin/env -S python3 -u\nprint(1)\n",
        b"#!/usr/bin/env python3\n# -*- coding: latin-1 -*-\nx = '\xe4'\n",
        b"#!/usr/bin/python3\nimport re\nre.match('\\d', '1')\n",
        b"#!/usr/bin/env bash\nprint 'x'\n",
    ],
)
def test_script_that_starts_has_no_fault(data: bytes) -> None:
    assert faults(data) == []


def test_missing_interpreter_and_old_text_are_both_named() -> None:
    assert len(faults(b"#!/usr/bin/env python\nprint 'a'\n")) == 2


def test_program_that_cannot_be_read_is_not_explained() -> None:
    assert explain_script("/nowhere/at/all", "/usr/bin") == ""
