"""`ur setup` on a computer that is just installed."""

from __future__ import annotations

from tests.hosts.bench import REPOSITORY, UR, Bench, Machine

SUDO = "pat ALL=(ALL) NOPASSWD: ALL\n"


def snapshot(laptop: Machine) -> str:
    return laptop.run("cd /home/pat; md5sum .bashrc .profile .zshenv .ros_setup 2>/dev/null; ls -A").check().out


def test_setup_prepares_shells_keys_and_packages_once_and_takes_them_back(bench: Bench) -> None:
    laptop = bench["laptop"]
    laptop.write("/etc/sudoers.d/pat", SUDO, mode=0o440)
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
    assert "installed" in laptop.run("dpkg-query -W -f='${db:Status-Status}' sshfs").out

    laptop.run(f"{UR} setup --undo --yes", user="pat").check()
    left = {line for line in snapshot(laptop).splitlines() if line not in fresh.splitlines()}
    assert left <= {".ssh", ".sudo_as_admin_successful"}


def test_setup_without_the_right_to_use_sudo_says_so(bench: Bench) -> None:
    laptop = bench["laptop"]
    laptop.run("rm -f /etc/sudoers.d/pat; apt-get -y remove rsync xauth").check()
    done = laptop.run(f"{UR} setup --yes", user="pat")
    assert done.code == 2
    assert "sudo refused" in done.err
    assert "Traceback" not in done.err


def test_setup_without_a_package_source_names_what_failed(bench: Bench) -> None:
    laptop = bench["laptop"]
    laptop.write("/etc/sudoers.d/pat", SUDO, mode=0o440)
    laptop.run("mv /srv/offered /srv/away; rm -rf /var/lib/apt/lists/*").check()
    done = laptop.run(f"{UR} setup --yes", user="pat")
    assert done.code == 2
    assert "packages" in done.err
    assert "/srv/offered" in done.err or "locate package" in done.err
