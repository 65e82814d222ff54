"""A robot in a world: MuJoCo physics behind the topics and services of stage_ros."""
