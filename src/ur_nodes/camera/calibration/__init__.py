"""Calibration of a camera with a printed chessboard; needs OpenCV (requirements/vision.lock)."""
