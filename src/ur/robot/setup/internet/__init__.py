"""This computer's connection to package servers, for a robot without internet, while it is being set up."""
