"""The computer's operating system: releases of Linux distributions, the packages of ROS 1, the Debian root."""
