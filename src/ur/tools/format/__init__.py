"""Order and layout of launch files, without a change of their meaning."""
