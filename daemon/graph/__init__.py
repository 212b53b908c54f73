"""Corners become vertices, lines become edges, the graph falls into strokes."""
