"""Inputs of many kinds, what was understood of them, and what was drawn, as a page of the documentation."""
