"""One loop moves bytes between a session and a port: serial, TCP, simulated."""
