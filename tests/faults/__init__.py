"""Every fault of every simulated machine in three moments: what is said of it, when, and whether it is the truth."""
