"""Completion candidates after `ur ...`, and the lines by which bash, zsh and fish request them."""
