"""Many drawings on the simulated machine, whose clock jumps: what of the daemon grows."""
