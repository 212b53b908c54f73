"""Strokes are simplified, put in order, and placed on the machine."""
