"""The simulated controller, GRBL 1.1h on a 328P: G-code parser, planner, main loop. `planner` times a program."""
