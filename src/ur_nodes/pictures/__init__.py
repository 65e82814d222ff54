"""Pictures of a camera on their way to people: unpacked, made smaller. Needs no OpenCV."""
