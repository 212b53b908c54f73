"""linedrawd: a picture becomes a value, the value walks through the rooms, and a machine draws it with a pen."""

__version__ = "0.1.0"
