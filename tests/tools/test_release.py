"""A release: refused before anything has happened, or built, tried, committed and tagged."""

import subprocess
from pathlib import Path

import pytest
from tools.release import ReleaseError, check_version, close_changelog, main, read_version, set_version

ROOT = Path(__file__).parents[2]
CHANGELOG = "# Changelog\n\n## Unreleased\n\n### Added\n\n- One.\n\n## 0.1.0 - 2026-01-01\n\n- Zero.\n"


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    folder = tmp_path / "clone"
    subprocess.run(["git", "clone", "-q", str(ROOT), str(folder)], check=True)
    git(folder, "config", "user.name", "A")
    git(folder, "config", "user.email", "a@b.invalid")
    changelog = folder / "CHANGELOG.md"
    text = changelog.read_text(encoding="utf-8")
    changelog.write_text(text.replace("## Unreleased\n", "## Unreleased\n\n### Added\n\n- Something new.\n", 1))
    git(folder, "commit", "-q", "-a", "-m", "docs: describe something new")
    return folder


def git(folder: Path, *arguments: str) -> str:
    return subprocess.run(["git", "-C", str(folder), *arguments], check=True, capture_output=True, text=True).stdout


def test_version_of_the_ros_package_is_that_of_the_project() -> None:
    project, package = ((ROOT / name).read_text() for name in ("pyproject.toml", "ubiquity_launches/package.xml"))
    assert read_version(package) == read_version(project)
    for text in (project, package):
        changed = set_version(text, "9.8.7")
        assert read_version(changed) == "9.8.7"
        assert changed.replace("9.8.7", read_version(text), 1) == text


@pytest.mark.parametrize(
    ("version", "why"),
    [("1.2", "is not a version"), ("v1.2.3", "is not a version"), ("0.9.9", "comes before"), ("1.0.0", "was released")],
)
def test_version_that_cannot_follow_is_refused(version: str, why: str) -> None:
    with pytest.raises(ReleaseError, match=why):
        check_version(version, "1.0.0", ["v1.0.0"])


def test_changes_move_below_their_version() -> None:
    text, changes = close_changelog(CHANGELOG, "0.2.0", "2026-02-03")
    assert changes == "### Added\n\n- One."
    assert text == CHANGELOG.replace("## Unreleased\n", "## Unreleased\n\n## 0.2.0 - 2026-02-03\n")
    with pytest.raises(ReleaseError, match="no changes"):
        close_changelog(text, "0.3.0", "2026-02-04")
    with pytest.raises(ReleaseError, match=r"has a section 0\.1\.0"):
        close_changelog(CHANGELOG, "0.1.0", "2026-02-04")


def test_section_that_has_its_date_stays_while_nothing_is_unreleased() -> None:
    dated = "# Changelog\n\n## Unreleased\n\n## 0.1.0 - 2026-01-01\n\n- Zero.\n\n## 0.0.1 - 2025-01-01\n\n- Before.\n"
    assert close_changelog(dated, "0.1.0", "2026-02-03") == (dated, "- Zero.")


def test_changes_of_a_version_that_was_never_released_belong_to_the_release() -> None:
    never = CHANGELOG.replace("## 0.1.0 - 2026-01-01", "## 0.1.0, not yet released")
    text, changes = close_changelog(never, "0.1.0", "2026-02-03")
    assert changes == "- Zero.\n\n### Added\n\n- One."
    assert text == "# Changelog\n\n## Unreleased\n\n## 0.1.0 - 2026-02-03\n\n- Zero.\n\n### Added\n\n- One.\n"
    between = never + "\n## 0.0.1 - 2025-01-01\n\n- Older.\n"
    text, _ = close_changelog(between, "0.2.0", "2026-02-03")
    assert text.endswith("- Zero.\n\n### Added\n\n- One.\n\n## 0.0.1 - 2025-01-01\n\n- Older.\n")


def test_changes_under_the_same_heading_come_together() -> None:
    never = "The first.\n\n### Added\n\n**Maps**\n\n- One.\n\n### Security\n\n- Two.\n"
    unreleased = "### Added\n\n- Three.\n\n### Fixed\n\n- Four.\n"
    text = f"# Changelog\n\n## Unreleased\n\n{unreleased}\n## 0.1.0, not yet released\n\n{never}"
    _, changes = close_changelog(text, "0.1.0", "2026-02-03")
    added = "### Added\n\n**Maps**\n\n- One.\n\n**More**\n\n- Three."
    assert changes == f"The first.\n\n{added}\n\n### Fixed\n\n- Four.\n\n### Security\n\n- Two."


def test_clone_with_changes_is_refused(clone: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (clone / "README.md").write_text("changed")
    assert main(["9.9.9", "--without-tests"], clone) == 2
    assert "the clone has changes, expected none: M README.md" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("echo 'web.lock: Found 1 known vulnerability'; exit 1", "vulnerabilities:\nweb.lock: Found 1"),
        (
            "echo 'help: this needs the index' >&2; exit 2",
            "could not be audited; --without-audit leaves it out\nhelp: ",
        ),
    ],
)
def test_release_with_locks_that_are_vulnerable_or_not_audited_is_refused(
    clone: Path, line: str, why: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (clone / "tools" / "audit_locks.bash").write_text(line)
    git(clone, "commit", "-q", "-a", "-m", "tools: report a vulnerability")
    assert main(["9.9.9", "--without-tests"], clone) == 2
    assert why in capsys.readouterr().err


def test_release_is_built_tried_and_tagged_and_a_dry_run_changes_nothing(
    clone: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, tags = git(clone, "rev-parse", "HEAD"), git(clone, "tag")
    assert main(["9.9.9", "--without-tests", "--without-audit", "--dry-run"], clone) == 0
    assert "tried ur 9.9.9, help of" in capsys.readouterr().out
    assert (git(clone, "rev-parse", "HEAD"), git(clone, "tag"), git(clone, "status", "--porcelain")) == (
        before,
        tags,
        "",
    )
    dist = tmp_path / "dist"
    assert main(["9.9.9", "--without-tests", "--without-audit", "--into", str(dist)], clone) == 0
    subprocess.run(["sha256sum", "--quiet", "--check", "SHA256SUMS"], cwd=dist, check=True)
    assert {each.name for each in dist.iterdir()} == {
        "SHA256SUMS",
        "ubiquity_launches-9.9.9.tar.gz",
        "ubiquity_launches-9.9.9-py3-none-any.whl",
    }
    assert git(clone, "rev-parse", "HEAD^") == before
    assert git(clone, "rev-parse", "v9.9.9^{commit}") == git(clone, "rev-parse", "HEAD")
    assert "### Added" in git(clone, "for-each-ref", "--format=%(contents)", "refs/tags/v9.9.9")
    assert read_version((clone / "pyproject.toml").read_text()) == "9.9.9"
    assert read_version((clone / "ubiquity_launches/package.xml").read_text()) == "9.9.9"
    assert "## 9.9.9 - " in (clone / "CHANGELOG.md").read_text()
    assert main(["9.9.9", "--without-tests"], clone) == 2
