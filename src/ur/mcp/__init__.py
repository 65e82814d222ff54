"""`ur mcp`: the selected robot, and the tools of `ur`, for an assistant that speaks the Model Context Protocol."""
