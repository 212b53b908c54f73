"""A page is segmented into background, lines and corners by the network."""
