"""What ends on a booted computer while its boards drive, and how soon the boards get zeros."""
