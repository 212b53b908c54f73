"""Dobot Magician: packets with a checksum, a queue of commands in the arm, and the arm in software."""
