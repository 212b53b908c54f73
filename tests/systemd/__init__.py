"""What systemd is told, what it is given to read, and what our files say to it."""
