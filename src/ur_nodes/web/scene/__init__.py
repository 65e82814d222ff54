"""The robot and what it sees in three dimensions, for pages: frames, model, markers and point clouds."""
