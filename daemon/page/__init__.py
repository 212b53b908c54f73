"""A page is put right before it is read: dark paper turned, line width brought to the network's range."""
