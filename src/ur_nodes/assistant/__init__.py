"""The robot's end of `ur mcp`: an assistant looks at the robot, and drives it on the terms of a grant."""
