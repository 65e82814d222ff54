"""What the package.xml and CMakeLists.txt of a launch package have to say, from what its launch files use."""

from __future__ import annotations
