"""Make docs/reference/rules from the rules and their examples. A test compares what is committed with this."""

from pathlib import Path

from ur.check.catalogue import load_rules
from ur.check.render.pages import render_index_page, render_rule_page

FOLDER = Path(__file__).parents[1] / "docs" / "reference" / "rules"


def make_pages() -> dict[str, str]:
    """File name to text: one page per rule, and the index."""
    rules = load_rules()
    return {"index.md": render_index_page(rules)} | {f"{rule.id}.md": render_rule_page(rule) for rule in rules.values()}


def main() -> None:
    """Write the pages, and remove those of rules that are gone."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    pages = make_pages()
    for path in FOLDER.glob("*.md"):
        if path.name not in pages:
            path.unlink()
    for name, text in pages.items():
        (FOLDER / name).write_text(text, encoding="utf-8")
    print(f"{len(pages)} pages in {FOLDER}")


if __name__ == "__main__":
    main()
