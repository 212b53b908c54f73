"""Random bytes, led by what they reach, into every parser: nothing but ProtocolError comes out, and nothing hangs."""
