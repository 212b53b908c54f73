"""Pictures and figures of what was given, understood and drawn."""
