"""A base from a description, as a user makes it who answers each question with what is suggested."""

import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bench.urdf_parts.descriptions import Robot

from ur.robot.description.reading import QUESTIONS, read_base_figures
from ur.robot.description.urdf_parts import Description
from ur.tools.new.description import FIGURES

_ROOT = Path(__file__).resolve().parents[2]
_SECONDS = 300.0


@dataclass(frozen=True, slots=True)
class Made:
    """A base: how many figures and sensors were read, what was asked for, and the problem ('' without one)."""

    read: int = 0
    asked: tuple[str, ...] = ()
    sensors: tuple[str, ...] = ()
    problem: str = ""
    findings: str = ""


def make_base(robot: Robot, workspace: Path, environment: Mapping[str, str]) -> Made:
    """Run `ur new base` once, with the suggested answer to each question, and `ur check` on the folder it makes."""
    if robot.description is None:
        return Made(problem=robot.problem)
    reading = read_base_figures(robot.description, {})
    lidar = [] if reading.has_lidar else ["--lidar"]
    answers = _answers(robot.description)
    options = [word for key, value in answers.items() for word in (f"--{key.replace('_', '-')}", f"{value:g}")]
    words = ["new", "base", robot.name, "--from", str(robot.path), "--workspace", str(workspace), *options, *lidar]
    code, text = _ur(words, environment)
    read = sum(key in QUESTIONS for key, figure in reading.figures.items() if key not in reading.open)
    asked = (*(key.replace("_", " ") for key in answers), *(["a lidar"] if lidar else []))
    made = Made(read, asked, tuple(sensor.kind for sensor in reading.sensors))
    if code != 0:
        return Made(made.read, made.asked, made.sensors, next(iter(_errors(text)), f"exit code {code}"))
    code, text = _ur(["check", str(workspace)], environment)
    return made if code == 0 else Made(made.read, made.asked, made.sensors, "", text.strip() or f"exit code {code}")


def clear_workspace(workspace: Path, name: str) -> None:
    """Remove the base that an earlier run has made in a kept folder; a folder of anything else stays."""
    if (workspace / "share" / "ubiquity_launches" / "bases" / name).is_dir():
        shutil.rmtree(workspace)


def _answers(description: Description) -> dict[str, float]:
    """The suggested figures for what the description leaves open."""
    open_ = read_base_figures(description, {}).open
    return {key: min(FIGURES[key][1], QUESTIONS[key][1]) for key in open_}


def _errors(text: str) -> list[str]:
    return [line.removeprefix("error: ") for line in text.splitlines() if line.startswith("error: ")]


def _ur(words: list[str], environment: Mapping[str, str]) -> tuple[int, str]:
    command = [sys.executable, "-m", "ur", *words]
    try:
        done = subprocess.run(
            command,
            env=dict(environment),
            cwd=_ROOT,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
            timeout=_SECONDS,
        )
    except subprocess.TimeoutExpired:
        return 1, f"error: 'ur {words[0]}' did not end within {_SECONDS:.0f} s"
    return done.returncode, done.stdout + done.stderr
