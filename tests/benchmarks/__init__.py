"""Benchmarks: figures for people, no assertion in them. `make bench` prints all of them."""
