"""The first hour with a machine: what stands in its way, and the test card that shows how it draws."""
