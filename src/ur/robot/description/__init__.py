"""Conversion of existing robot descriptions (URDF, xacro) to base files.

`parse` makes a `Description` of a URDF, `reading` derives the properties of a base from it and lists missing ones as
questions, `base_text` writes the base.yaml. All of these are pure. `surroundings` finds the folders that may be read,
`expansion` runs xacro.
"""
