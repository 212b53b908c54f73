"""GRBL 1.1: replies, codes, motion in time, the sender's session and the simulated controller."""
