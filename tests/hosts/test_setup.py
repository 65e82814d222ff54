"""`ur setup` on a computer that is just installed."""

from tests.hosts.bench import REPOSITORY, UR, Machine
from tests.hosts.conftest import SUDO

from ur.robot.setup.viewer_states import GROUPS, PACKAGES


def snapshot(laptop: Machine) -> list[str]:
    """All of a home folder, byte for byte, but keys, which stay, and sudo's own mark."""
    script = (
        "cd /home/pat; "
        "find . -path ./.ssh -prune -o ! -name .sudo_as_admin_successful -printf '%M %u %p %l\\n' | sort; "
        "find . -path ./.ssh -prune -o -type f ! -name .sudo_as_admin_successful -exec sha256sum {} + | sort"
    )
    return laptop.run(script).check().out.splitlines()


def test_setup_prepares_shells_keys_and_packages_once_and_takes_them_back(laptop: Machine) -> None:
    fresh = snapshot(laptop)
    shown = laptop.run(f"{UR} setup --dry-run", user="pat").check()
    assert "+++ ~/.bashrc" in shown.out
    assert snapshot(laptop) == fresh

    laptop.run(f"{UR} setup --yes", user="pat", timeout=300).check()
    assert laptop.run(f"{UR} setup --yes", user="pat").check().out.startswith("nothing to do")
    # A shell that is neither a login shell nor interactive, by key, to its own full name: what roslaunch needs.
    inside = "ssh -o BatchMode=yes -o StrictHostKeyChecking=yes laptop.local 'echo $ROS_MASTER_URI; command -v ur'"
    said = laptop.run(inside, user="pat").check().out
    assert said.split() == ["http://localhost:11311", f"{REPOSITORY}/ubiquity_launches/bin/ur"]
    said = laptop.run("zsh -c 'echo $ROS_MASTER_URI; command -v ur'", user="pat").check().out
    assert said.split() == ["http://localhost:11311", f"{REPOSITORY}/ubiquity_launches/bin/ur"]
    installed = laptop.run("dpkg-query -W -f='${db:Status-Status} ${Package}\\n'").out.splitlines()
    assert [entry for entry in PACKAGES if not any(f"installed {name}" in installed for name in entry.split("|"))] == []
    existing = {line.split(":")[0] for line in laptop.read("/etc/group").splitlines()}
    assert existing & set(GROUPS) <= set(laptop.run("id -nG pat").out.split())

    taken = laptop.run(f"{UR} setup --undo --yes", user="pat").check()
    assert "Traceback" not in taken.err
    assert snapshot(laptop) == fresh
    assert laptop.run(f"{UR} setup --undo --yes", user="pat").check().out == "nothing to take back\n"
    keys = set(laptop.run("cd /home/pat/.ssh; ls").out.split())
    assert {"id_ed25519", "id_ed25519.pub"} <= keys  # ssh itself may have learnt further host keys
    assert "authorized_keys" not in keys


def test_setup_without_the_right_to_use_sudo_says_so(laptop: Machine) -> None:
    laptop.run("rm -f /etc/sudoers.d/pat; apt-get -y remove rsync xauth").check()
    done = laptop.run(f"{UR} setup --yes", user="pat")
    assert done.code == 2
    assert "sudo refused" in done.err
    assert "Traceback" not in done.err


def test_setup_without_a_package_source_names_what_failed(laptop: Machine) -> None:
    laptop.write("/etc/sudoers.d/pat", SUDO, mode=0o440)
    laptop.run("mv /srv/offered /srv/away; rm -rf /var/lib/apt/lists/*").check()
    done = laptop.run(f"{UR} setup --yes", user="pat")
    assert done.code == 2
    assert "packages" in done.err
    assert "/srv/offered" in done.err or "locate package" in done.err
