"""Robot descriptions of others (URDF, xacro) and the base files that follow from them.

`parse` makes a `Description` of a URDF, `reading` reads the figures of a base from it and lists the questions that
remain, `base_text` writes the base.yaml. All of these are pure. `surroundings` finds the folders that may be read,
`expansion` runs xacro.
"""

from __future__ import annotations
