"""The robot and its surroundings in three dimensions, for pages: frames, model, markers and point clouds."""
