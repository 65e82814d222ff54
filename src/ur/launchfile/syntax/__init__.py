"""The parser: launch text to a tree with positions; pure; never raises on user input."""

from ur.launchfile.syntax.parse import parse_launch_file
from ur.launchfile.syntax.substitution import (
    Substitution,
    SubstitutionProblem,
    SubstitutionWord,
    is_eval,
    parse_substitutions,
)
from ur.launchfile.syntax.tree import Comment, Element, LaunchFile

__all__ = [
    "Comment",
    "Element",
    "LaunchFile",
    "Substitution",
    "SubstitutionProblem",
    "SubstitutionWord",
    "is_eval",
    "parse_launch_file",
    "parse_substitutions",
]
