"""Launch files in house order and layout, meaning what they meant before."""

from __future__ import annotations
