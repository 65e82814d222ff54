"""The computer's own system: releases of Linux distributions and the Debian packages that ROS 1 consists of."""
