"""Pictures of a camera for display: decoded and made smaller, without OpenCV."""
