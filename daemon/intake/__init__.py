"""Files become pages: inbox, decoders, size limits."""
