"""Topics for viewers of other makers: the server of foxglove-sdk, which needs requirements/foxglove.lock."""
