"""Where names of launch files are defined and used, over a whole workspace."""

from __future__ import annotations
