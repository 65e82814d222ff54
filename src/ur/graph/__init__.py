"""Pictures of launch files and of what runs: trees and graphs, and the forms they are written in."""

from __future__ import annotations
