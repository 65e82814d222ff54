"""The names of roslib that this project uses."""
