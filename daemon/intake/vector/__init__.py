"""Files that hold lines become drawings without being seen: SVG and DXF."""
