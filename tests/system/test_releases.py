"""The table of releases: well-formed, and looked up alike by Python and bash."""

import subprocess
from pathlib import Path

import pytest

from ur.source.diagnostic import UserError
from ur.system.releases import (
    Release,
    System,
    check_robot_system,
    find_release,
    load_releases,
    load_ros_packages,
    parse_os_release,
    parse_releases,
)

ROOT = Path(__file__).parents[2]
BASH = ROOT / "src/ur/system/releases.bash"
DEBIAN_12 = 'PRETTY_NAME="Debian GNU/Linux 12 (bookworm)"\nID=debian\nVERSION_ID="12"\nVERSION_CODENAME=bookworm\n'
TESTING = 'PRETTY_NAME="Debian GNU/Linux forky/sid"\nVERSION_CODENAME=forky\nID=debian\n'
NOBLE = (
    'PRETTY_NAME="Ubuntu 24.04.3 LTS"\nVERSION_ID="24.04"\nVERSION_CODENAME=noble\nID=ubuntu\nID_LIKE=debian\n'
    "UBUNTU_CODENAME=noble\n"
)
MINT = (
    'PRETTY_NAME="Linux Mint 22.1"\nID=linuxmint\nID_LIKE="ubuntu debian"\nVERSION_ID="22.1"\nVERSION_CODENAME=xia\n'
    "UBUNTU_CODENAME=noble\n"
)
MINT_21 = MINT.replace("22.1", "21.3").replace("xia", "virginia").replace("noble", "jammy")
LMDE = (
    "PRETTY_NAME='LMDE 7 (gigi)'\nID=linuxmint\nID_LIKE=debian\nVERSION_ID=\"7\"\nVERSION_CODENAME=gigi\n"
    "DEBIAN_CODENAME=trixie\n"
)
KALI = (
    'PRETTY_NAME="Kali GNU/Linux Rolling"\nID=kali\nID_LIKE=debian\n'
    'VERSION_ID="2026.3"\nVERSION_CODENAME=kali-rolling\n'
)
DERIVED = 'PRETTY_NAME="X 1"\nID=x\nID_LIKE="debian"\nVERSION_ID="1"\nVERSION_CODENAME=bookworm\n'
RASPBIAN = (
    'PRETTY_NAME="Raspbian GNU/Linux 12 (bookworm)"\nID=raspbian\nID_LIKE=debian\n'
    'VERSION_ID="12"\nVERSION_CODENAME=bookworm\n'
)
LATER = NOBLE.replace("24.04.3 LTS", "27.10").replace("24.04", "27.10").replace("noble", "unheard")
ROCKY = 'PRETTY_NAME="Rocky Linux 10.0"\nID="rocky"\nID_LIKE="rhel centos fedora"\nVERSION_ID="10.0"\n'
MANJARO = 'PRETTY_NAME="Manjaro Linux"\nID=manjaro\nID_LIKE=arch\n'
PLAN_9 = 'ID=plan9\nPRETTY_NAME="Plan 9"\n'
SYSTEMS = {
    "debian 12": (DEBIAN_12, "Debian 12", "native", True),
    "testing": (TESTING, "Debian 14 (testing)", "native", None),
    "debian 11": (DEBIAN_12.replace("12", "11").replace("bookworm", "bullseye"), "Debian 11", "refused", False),
    "noble": (NOBLE, "Ubuntu 24.04", "brought", None),
    "mint 22": (MINT, "Ubuntu 24.04", "brought", False),
    "mint 21": (MINT_21, "Ubuntu 22.04", "native", False),
    "lmde 7": (LMDE, "Debian 13", "native", False),
    "kali": (KALI, "other releases of Debian", "brought", False),
    "derived": (DERIVED, "Debian 12", "native", False),
    "raspbian": (RASPBIAN, "32-bit Raspberry Pi OS", "refused", False),
    "later ubuntu": (LATER, "other releases of Ubuntu", "brought", False),
    "rocky": (ROCKY, "Fedora", "brought", False),
    "manjaro": (MANJARO, "Arch Linux", "brought", False),
    "plan 9": (PLAN_9, "any other system", "refused", False),
    "nothing": ("", "any other system", "refused", False),
    "no assignments": ("hello\n\n# ID=debian\n=\n", "any other system", "refused", False),
}


@pytest.mark.parametrize(("text", "name", "ros", "tried"), SYSTEMS.values(), ids=SYSTEMS)
def test_system_is_found_by_release_then_base_then_family(text: str, name: str, ros: str, tried: bool | None) -> None:
    found = find_release(parse_os_release(text))
    assert (found.name, found.ros) == (name, ros)
    assert tried is None or found.tried is tried


@pytest.mark.parametrize("text", [each[0] for each in SYSTEMS.values()], ids=SYSTEMS)
def test_bash_finds_the_same_release(text: str, tmp_path: Path) -> None:
    file = tmp_path / "os-release"
    file.write_text(text)
    names = ("id", "version", "codename", "ros", "missing", "tried", "name", "note", "pretty")
    show = " ".join(f'"$release_{name}"' for name in names)
    script = f'set -u; . "$1"; find_release "$2" || exit; printf "%s\\n" {show}'
    done = subprocess.run(
        ["bash", "-c", script, "bash", str(BASH), str(file)], capture_output=True, text=True, check=True, timeout=60
    )
    system = parse_os_release(text)
    found = find_release(system)
    tried = "yes" if found.tried else "no"
    missing = ",".join(found.missing)
    row = [found.id, found.version, found.codename, found.ros, missing, tried, found.name, found.note, system.name]
    assert (done.stdout.splitlines(), done.stderr) == (row, "")


def test_bash_refuses_a_system_without_os_release(tmp_path: Path) -> None:
    script = '. "$1"; find_release "$2"; echo "$? $release_ros $release_pretty"'
    words = ["bash", "-c", script, "bash", str(BASH), str(tmp_path / "none")]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60)
    assert (done.stdout, done.stderr) == ("1 refused Linux\n", "")


def test_bash_reads_the_same_packages() -> None:
    words = ["bash", "-c", '. "$1"; read_ros_packages', "bash", str(BASH)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60)
    assert tuple(done.stdout.splitlines()) == load_ros_packages()


def test_table_has_one_row_for_each_system_and_ends_with_any() -> None:
    rows = load_releases()
    keys = [(row.id, row.version) for row in rows]
    assert len(set(keys)) == len(keys)
    assert keys[-1] == ("*", "*")
    assert rows[-1].ros == "refused"


@pytest.mark.parametrize("row", load_releases(), ids=lambda row: row.name)
def test_row_is_consistent(row: Release) -> None:
    known = {name for entry in load_ros_packages() for name in entry.split("|")} | {"all", "rviz"}
    assert set(row.missing) <= known
    assert (row.ros == "brought") >= ("all" in row.missing)
    assert row.ros != "native" or "all" not in row.missing
    assert not row.tried or row.ros != "refused"
    if row.lists:
        assert row.codename
        assert row.lists.startswith("20") or row.lists == "measured"
    if row.codename:
        exact = System(id=row.id, version=row.version, codename=row.codename)
        assert find_release(exact) == row
    if row.ros == "refused" and row.id != "*":
        assert row.note, "a refusal says why"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected the columns id version"),
        ("id\tversion\n", "expected the columns id version"),
        ("{head}\ndebian\t12\n", "releases.tsv:2: expected 9 columns"),
        ("{head}\ndebian\t12\tx\tnative\t\t-\tno\tX\t-\n", "each with a value or -"),
        ("{head}\ndebian\t12\tx\tperhaps\t-\t-\tno\tX\t-\n", "ros is 'perhaps', expected native, brought or refused"),
        (
            "{head}\n# x\ndebian\t12\tx\tnative\t-\t-\tmaybe\tX\t-\n",
            "releases.tsv:3: tried is 'maybe', expected yes or no",
        ),
    ],
)
def test_malformed_table_is_refused_with_its_line(text: str, message: str) -> None:
    head = "id\tversion\tcodename\tros\tmissing\tlists\ttried\tname\tnote"
    with pytest.raises(ValueError, match=message):
        parse_releases(text.replace("{head}", head))


def test_quoted_values_are_read_as_a_shell_reads_them() -> None:
    system = parse_os_release('ID=\'debian\'\nPRETTY_NAME="A \\"B\\" \'c\'"\nVERSION_ID="unfinished\nID_LIKE=\n')
    assert system == System(id="debian", name="A \"B\" 'c'")


@pytest.mark.parametrize("text", [DEBIAN_12, TESTING, MINT_21, LMDE], ids=["12", "testing", "mint", "lmde"])
def test_robot_with_ros_packages_is_accepted(text: str) -> None:
    check_robot_system("bob.img", parse_os_release(text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (NOBLE, "bob.img: Ubuntu 24.04.3 LTS does not package ROS 1, expected Debian 12 or 13, or Raspberry Pi OS"),
        (MINT, "bob.img: Linux Mint 22.1 does not package ROS 1, expected"),
        (RASPBIAN, "bob.img: Raspbian GNU/Linux 12 (bookworm) is not supported: its packages are for armhf"),
        (PLAN_9, "bob.img: Plan 9 is not supported, expected Debian 12 or 13"),
    ],
)
def test_robot_without_ros_packages_is_refused_with_the_alternative(text: str, message: str) -> None:
    with pytest.raises(UserError) as caught:
        check_robot_system("bob.img", parse_os_release(text))
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.message.startswith(message)
    assert diagnostic.help == "flash an image of one of these"
