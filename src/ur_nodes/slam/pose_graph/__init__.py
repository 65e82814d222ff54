"""The pose graph of keyframes: relative poses, loops and the path of the robot."""
