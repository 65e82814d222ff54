"""The frames of a robot's links, where no upstream robot_state_publisher is installed."""
