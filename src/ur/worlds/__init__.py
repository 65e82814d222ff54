"""World files and floor plans of the simulator: read, validated, and made from pictures."""

from __future__ import annotations
