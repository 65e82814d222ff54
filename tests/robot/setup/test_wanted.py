"""Wanted states: what they would change, and that doing it for real on files of this computer gives the wanted ones."""

import getpass
from dataclasses import replace
from pathlib import Path

import pytest

from ur.robot.setup.change import Change
from ur.robot.setup.engine import apply_change
from ur.robot.setup.facts import ABSENT, ComputerFacts, FactsRequest, FileState, fact_script, parse_facts
from ur.robot.setup.keys import AUTHORIZED, KEY, WantedKeyPair, WantedOwnLogin
from ur.robot.setup.made import RECORD, WantedRecord, kept_path
from ur.robot.setup.packages import WantedPackages, WantedService
from ur.robot.setup.wanted import Wanted, WantedFile, WantedFolder, WantedGroups, WantedLine
from ur.robot.ssh.shell import LocalShell
from ur.source.diagnostic import UserError

FACTS = ComputerFacts("pat", "/home/pat", "laptop", "debian bookworm", "1", frozenset({"pat", "video"}))
LINE = ". ~/.ros_setup # ours"


def with_file(path: str, text: str | None, mode: int = 0o644) -> ComputerFacts:
    state = ABSENT if text is None else FileState(text, mode, "pat")
    return replace(FACTS, files={path: state, RECORD: ABSENT, kept_path(path): ABSENT})


def written(change: Change | None) -> object:
    assert change is not None
    return change.commands[0].stdin


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (None, f"{LINE}\n"),
        ("", f"{LINE}\n"),
        ("mine\n", f"{LINE}\nmine\n"),
        ("mine without an end", f"{LINE}\nmine without an end"),
        (f"mine\n{LINE}\nmore\n", f"{LINE}\nmine\nmore\n"),
        (f"{LINE}\n{LINE}\nmine\n", f"{LINE}\nmine\n"),
        ("a form feed \x0c stays\r\n", f"{LINE}\na form feed \x0c stays\r\n"),
        ("Latin-1 \udce9\n", f"{LINE}\nLatin-1 \udce9\n"),
    ],
)
def test_first_line_is_put_before_the_users_own(before: str | None, after: str) -> None:
    item = WantedLine("reads it", "~/.bashrc", LINE, first=True)
    assert written(item.plan(with_file("~/.bashrc", before))) == after
    assert item.plan(with_file("~/.bashrc", after)) is None


@pytest.mark.parametrize("before", [None, "mine\n", "mine without an end", "\x0c\r\n\nmine\n"])
def test_first_line_is_taken_back_without_a_trace(before: str | None) -> None:
    item = WantedLine("reads it", "~/.bashrc", LINE, first=True)
    after = str(written(item.plan(with_file("~/.bashrc", before))))
    facts = with_file("~/.bashrc", after)
    if before is None:
        facts = replace(facts, files={**facts.files, RECORD: FileState("/home/pat/.bashrc\n")})
    undo = item.undo(facts)
    assert undo is not None
    if before is None:
        assert "; rm -f " in undo.commands[0].script
    else:
        assert undo.commands[0].stdin == before
    assert item.undo(with_file("~/.bashrc", before)) is None


def test_known_host_replaces_the_line_that_an_earlier_key_left() -> None:
    item = WantedLine("host key", "~/.ssh/known_hosts", "r.local,r ed new", mode=0o600, old=("r.local,",))
    facts = with_file("~/.ssh/known_hosts", "other ed x\nr.local,r ed old\n", 0o600)
    assert written(item.plan(facts)) == "other ed x\nr.local,r ed new\n"


def test_line_in_a_file_that_others_may_read_takes_that_right_away() -> None:
    item = WantedLine("who may log in", "~/.ssh/authorized_keys", "key", mode=0o600)
    change = item.plan(with_file("~/.ssh/authorized_keys", "key\n", 0o664))
    assert change
    assert "664 -> 600" in change.difference
    assert item.plan(with_file("~/.ssh/authorized_keys", "key\n", 0o600)) is None


def test_file_that_somebody_changed_is_not_removed() -> None:
    item = WantedFile("environment", "~/.ros_setup", "ours\n")
    assert item.undo(with_file("~/.ros_setup", "ours\n"))
    assert item.undo(with_file("~/.ros_setup", "ours\nand mine\n")) is None


def test_file_outside_the_home_folder_is_written_as_root() -> None:
    change = WantedFile("robot", "/etc/ubiquity/robot.yaml", "x\n").plan(with_file("/etc/ubiquity/robot.yaml", None))
    assert change
    assert change.commands[0].root


def test_packages_count_as_there_when_an_alternative_is() -> None:
    item = WantedPackages("packages", ("a|b", "c", "d"))
    assert item.missing(replace(FACTS, packages={"b": "1", "d": "1"})) == ["c"]


def test_user_joins_only_groups_that_exist() -> None:
    change = WantedGroups("groups", ("video", "dialout", "nowhere")).plan(
        with_file("/etc/group", "video:x:\ndialout:x:\n")
    )
    assert change
    assert change.difference == "pat joins dialout"


@pytest.mark.parametrize(
    ("active", "enabled", "change"), [("active", "enabled", False), ("failed", "enabled", True), ("", "", True)]
)
def test_service_is_started_unless_it_runs(active: str, enabled: str, change: bool) -> None:
    from ur.robot.setup.facts import ServiceState

    facts = replace(FACTS, services={"x.service": ServiceState(active, enabled)})
    assert bool(WantedService("x", "x.service").plan(facts)) is change


def look_at(home: Path, items: list[Wanted]) -> ComputerFacts:
    """The facts of a home folder that nobody has."""
    request = FactsRequest("nobody-else")
    for item in items:
        request |= item.request("nobody-else")
    script = (
        fact_script(request)
        .replace("home=$(getent", f"home={home}; : $(getent")
        .replace("id -nG nobody-else", f"id -nG {getpass.getuser()}")
    )
    return parse_facts(request, LocalShell().run(script).out)


def snapshot(home: Path) -> dict[str, tuple[str, int, bytes | str]]:
    """Everything below a folder: kind, rights and content."""
    found: dict[str, tuple[str, int, bytes | str]] = {}
    for path in sorted(home.rglob("*")):
        name, mode = str(path.relative_to(home)), path.lstat().st_mode
        if path.is_symlink():
            found[name] = ("link", mode, str(path.readlink()))
        else:
            found[name] = ("folder", mode, "") if path.is_dir() else ("file", mode, path.read_bytes())
    return found


HOMES: dict[str, dict[str, str | None]] = {  # None: a folder
    "nothing": {},
    "Debian's": {".bashrc": "# mine\n", ".profile": "umask 022\n"},
    "empty files": {".bashrc": "", ".zshenv": "", ".zshrc": ""},
    "no end of the last line": {".bashrc": "mine", ".zshrc": "mine"},
    "empty folders": {".config": None, ".config/fish": None, "catkin_ws": None, ".local/share": None},
    "an empty workspace": {"catkin_ws/src": None},
    "an environment of one's own": {".ros_setup": "export ROS_MASTER_URI=http://mine:11311\n"},
    "links": {"dot/bashrc": "mine\n", ".bashrc": "-> dot/bashrc", "dot/zshrc": "mine", ".zshrc": "-> dot/zshrc"},
    "links to nothing": {"dot": None, ".bashrc": "-> dot/bashrc", ".zshrc": "-> nowhere/zshrc"},
}


@pytest.mark.parametrize("content", HOMES.values(), ids=HOMES)
@pytest.mark.parametrize("times", [1, 2])
def test_home_is_byte_for_byte_what_it_was_once_all_is_taken_back(
    content: dict[str, str | None], times: int, tmp_path: Path
) -> None:
    for name, text in content.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        if text is None:
            (tmp_path / name).mkdir(parents=True, exist_ok=True)
        elif text.startswith("-> "):
            (tmp_path / name).symlink_to(text[3:])
        else:
            (tmp_path / name).write_text(text)
            (tmp_path / name).chmod(0o640)
    before = snapshot(tmp_path)
    for version in range(times):
        make(tmp_path, home_items(version))
    assert snapshot(tmp_path) != before
    for _ in range(2):
        take_back(tmp_path, home_items(times - 1))
        assert snapshot(tmp_path) == before


def test_what_the_user_wrote_in_between_stays_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / ".bashrc").write_text("mine\n")
    (tmp_path / ".zshrc").write_text("mine")
    make(tmp_path, home_items(0))
    for name in (".bashrc", ".zshrc", ".zshenv"):
        with (tmp_path / name).open("a") as file:
            file.write("later\n")
    (tmp_path / "catkin_ws/src/package.xml").write_text("x")
    take_back(tmp_path, home_items(0))
    left = {name: content for name, (kind, _, content) in snapshot(tmp_path).items() if kind == "file"}
    assert left == {
        ".bashrc": b"mine\nlater\n",
        ".zshrc": b"mine\nlater\n",
        ".zshenv": b"later\n",
        "catkin_ws/src/package.xml": b"x",
    }


def home_items(version: int) -> list[Wanted]:
    return [
        WantedRecord(),
        WantedFile("environment", "~/.ros_setup", f"export A={version}\n"),
        WantedLine("bash", "~/.bashrc", LINE, first=True),
        WantedLine("zsh", "~/.zshenv", LINE, first=True),
        WantedFolder("workspace", "~/catkin_ws/src"),
        WantedFile("Tab in fish", "~/.config/fish/completions/ur.fish", f"# {version}\n"),
        WantedLine("zsh reads it", "~/.zshrc", LINE),
    ]


def make(home: Path, items: list[Wanted]) -> None:
    facts = look_at(home, items)  # once, since asking takes long
    for item in items:
        change = item.plan(facts)
        if change:
            apply_change(LocalShell(), change)
    facts = look_at(home, items)
    assert [item.title for item in items if item.plan(facts)] == []


def take_back(home: Path, items: list[Wanted]) -> None:
    facts = look_at(home, items)  # once, as `ur setup --undo` does
    for item in reversed(items):
        change = item.undo(facts)
        if change:
            apply_change(LocalShell(), change)


def test_missing_ssh_keygen_is_named_with_its_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    change = WantedKeyPair("key", KEY, "pat@laptop").plan(replace(FACTS, files={KEY: ABSENT, f"{KEY}.pub": ABSENT}))
    assert change is not None
    for tool in ("bash", "sh"):
        (tmp_path / tool).symlink_to(f"/bin/{tool}")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match="openssh-client"):
        apply_change(LocalShell(), change)


def test_changes_bring_about_what_was_wanted_and_back(tmp_path: Path) -> None:
    (tmp_path / ".bashrc").write_bytes(b"# Latin-1 \xe9\nmine")
    items: list[Wanted] = [
        WantedFile("environment", "~/.ros_setup", "export A='ü'\n"),
        WantedLine("bash", "~/.bashrc", LINE, first=True),
        WantedFolder("workspace", "~/catkin_ws/src"),
        WantedFolder("ssh", "~/.ssh", mode=0o700),
        WantedKeyPair("key", KEY, "nobody-else@laptop"),
        WantedOwnLogin("itself"),
        WantedLine("another", AUTHORIZED, "ssh-ed25519 other", mode=0o600),
    ]
    shell = LocalShell()

    def look() -> ComputerFacts:
        return look_at(tmp_path, items)

    for item in items:
        change = item.plan(look())
        assert change, item
        apply_change(shell, change)
    assert [item.title for item in items if item.plan(look())] == []
    assert (tmp_path / ".bashrc").read_bytes() == f"{LINE}\n".encode() + b"# Latin-1 \xe9\nmine"
    assert (tmp_path / ".ssh/id_ed25519").stat().st_mode & 0o777 == 0o600
    public = (tmp_path / ".ssh/id_ed25519.pub").read_text()
    assert (tmp_path / ".ssh/authorized_keys").read_text() == f"{public}ssh-ed25519 other\n"
    for item in reversed(items):
        change = item.undo(look())
        if change:
            apply_change(shell, change)
    assert (tmp_path / ".bashrc").read_bytes() == b"# Latin-1 \xe9\nmine"
    assert not (tmp_path / ".ros_setup").exists()
    assert not (tmp_path / "catkin_ws").exists()
    assert sorted(path.name for path in (tmp_path / ".ssh").iterdir()) == ["id_ed25519", "id_ed25519.pub"]


def test_file_that_is_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "dotfiles").write_text("mine\n")
    (tmp_path / ".bashrc").symlink_to("dotfiles")
    facts = replace(with_file("~/.bashrc", "mine\n"), home=str(tmp_path))
    change = WantedLine("bash", "~/.bashrc", LINE, first=True).plan(facts)
    assert change
    apply_change(LocalShell(), change)
    assert (tmp_path / ".bashrc").is_symlink()
    assert (tmp_path / "dotfiles").read_text() == f"{LINE}\nmine\n"


def test_text_that_did_not_arrive_whole_is_not_written(tmp_path: Path) -> None:
    facts = replace(with_file("~/.bashrc", "mine\n"), home=str(tmp_path))
    (tmp_path / ".bashrc").write_text("mine\n")
    change = WantedLine("bash", "~/.bashrc", LINE, first=True).plan(facts)
    assert change
    assert LocalShell().run(change.commands[0].script, stdin=LINE[:5]).code != 0
    assert (tmp_path / ".bashrc").read_text() == "mine\n"
    assert [path.name for path in tmp_path.glob(".bashrc*")] == [".bashrc"]


@pytest.mark.parametrize(
    "part", ["file /etc/group\nrwx root file\n", "file /etc/group\n644 root file\nA\n", "file /etc/group\n644\n"]
)
def test_answer_that_makes_no_sense_is_an_error_and_no_defect(part: str) -> None:
    names = ("home", "hostname", "system", "boot", "groups", "addresses", "broken")
    said = "".join(f"\x1e{name}\nx\n" for name in names) + f"\x1e{part}\x1eend\n"
    with pytest.raises(UserError, match="cannot be read"):
        parse_facts(FactsRequest("ros", files=frozenset({"/etc/group"})), said)


def test_answer_without_its_parts_is_an_error_and_no_defect() -> None:
    with pytest.raises(UserError, match="cannot be read"):
        parse_facts(FactsRequest("ros"), "\x1eend\n")
