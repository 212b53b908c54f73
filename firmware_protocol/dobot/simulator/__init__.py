"""The arm in software: the wire, the queue, the motion by inverse kinematics, and what can go wrong."""
