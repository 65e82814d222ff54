"""`ur mcp`: the selected robot, and the tools of `ur`, for an assistant that speaks the Model Context Protocol."""

PACKAGES = ["mcp", "mcp_types"], "mcp.lock", "what assistants need (20 MB to download)"
NOT_INSTALLED = "what assistants need is not installed; install it first: {} mcp --install"
