"""What pen-holding machines say and expect: sessions without I/O, clock or thread, and simulators that answer them."""
