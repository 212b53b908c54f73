"""The real daemon draws on a simulated machine in another process, and everything that can be killed is killed."""
