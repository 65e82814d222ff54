#!/usr/bin/env python3
"""Write the column "may import" of docs/reference/layers.md from the table that tests/form/test_layers.py enforces."""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reference" / "layers.md"


def main() -> None:
    """Rewrite the page. A package without a row is named on standard error."""
    sys.path.insert(0, str(ROOT))
    from tests.form.test_layers import MAY_IMPORT

    missing = set(MAY_IMPORT)

    def write_row(row: re.Match[str]) -> str:
        name, contents = row.groups()
        if name not in MAY_IMPORT:
            return row[0]
        missing.discard(name)
        allowed = ", ".join(f"`{each}`" for each in MAY_IMPORT[name]) or "only itself"
        return f"| `{name}` | {contents} | {allowed} |"

    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(re.sub(r"^\| `([a-z_0-9.]+)` \| (.*) \| [^|]* \|$", write_row, text, flags=re.M), encoding="utf-8")
    for name in sorted(missing):
        sys.stderr.write(f"{PAGE.name}: no row for {name}, expected one that says what it contains\n")


if __name__ == "__main__":
    main()
