"""Files that hold lines become drawings without being seen: SVG, DXF and PDF."""
