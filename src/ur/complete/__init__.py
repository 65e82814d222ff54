"""Completion candidates after `ur ...`, and the few lines that make bash, zsh and fish ask for it."""

from __future__ import annotations
