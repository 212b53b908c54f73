"""The simulated control of an EMCO mill: reads programs, moves the pen in time; `motion` times a program."""
