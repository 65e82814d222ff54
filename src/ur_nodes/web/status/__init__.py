"""The state of the robot and its computer for pages: diagnostics, processor, memory, disk, wireless."""
