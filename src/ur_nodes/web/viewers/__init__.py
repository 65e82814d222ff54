"""Topics for third-party viewers, through the server of foxglove-sdk, which needs requirements/foxglove.lock."""
