"""Pictures of launch files and of running nodes: trees and graphs, and their output formats."""

from __future__ import annotations
