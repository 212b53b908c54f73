"""The shipped network and its manifest."""
