"""A robot in a world: MuJoCo physics behind the topics and services of stage_ros."""

import os

os.environ.setdefault("MUJOCO_GL", "off")  # physics draws nothing; see camera_process for what does
