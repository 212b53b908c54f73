"""A toolpath is written down for a controller or for a person: G-code, SVG."""
