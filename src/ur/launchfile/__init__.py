"""Launch files: text to tree (syntax), packages and files (world), tree to plan (plan)."""
