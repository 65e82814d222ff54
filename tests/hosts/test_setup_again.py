"""`ur setup` of a home folder as people have it: repeated, killed at every change, and taken back."""

from tests.hosts.bench import UR, Machine
from tests.hosts.test_robot_setup_interrupted import run_until
from tests.hosts.test_setup import snapshot

# A home folder as people have it, made by pat.
MINE = """\
mkdir -p .config catkin_ws/src dot && printf 'export A=1' >dot/zshrc && ln -s dot/zshrc .zshrc
: >.zshenv; printf 'mine\\n\\n' >>.bashrc
printf 'export ROS_MASTER_URI=http://mine:11311\\n' >.ros_setup; chmod 600 .ros_setup
"""


def test_setup_of_a_home_with_own_files_is_taken_back_byte_for_byte(laptop: Machine) -> None:
    laptop.run(MINE, user="pat").check()
    before = snapshot(laptop)
    for _ in range(2):
        laptop.run(f"{UR} setup --yes", user="pat", timeout=300).check()
        laptop.run("sed -i s/ubiquity_launches/edited/ ~/.bashrc", user="pat").check()  # ours, which comes back
    laptop.run(f"{UR} setup --yes", user="pat", timeout=300).check()
    assert "http://localhost:11311" in laptop.run("bash -ic 'echo $ROS_MASTER_URI'", user="pat").out
    laptop.run("sed -i /edited/d ~/.bashrc", user="pat").check()
    laptop.run(f"{UR} setup --undo --yes", user="pat").check()
    assert snapshot(laptop) == before


def test_setup_killed_at_every_change_is_finished_by_the_next_and_taken_back(laptop: Machine) -> None:
    before = snapshot(laptop)

    def kill(number: int) -> None:
        laptop.run(f"kill -KILL {number}")

    shown = laptop.run(f"{UR} setup --dry-run", user="pat").check().out
    titles = [line.removesuffix(":") for line in shown.splitlines() if line and not line.startswith(" ")]
    assert len(titles) >= 8
    for title in titles:
        said, _ = run_until(laptop, f"{UR} setup --yes", "", {f"{title} ...": kill})
        assert "Traceback" not in "".join(said)
    laptop.run(f"{UR} setup --yes", user="pat", timeout=300).check()
    for _ in titles:
        said, _code = run_until(laptop, f"{UR} setup --undo --yes", "", {f"{titles[-1]} ...": kill})
    laptop.run(f"{UR} setup --undo --yes", user="pat").check()
    assert snapshot(laptop) == before
