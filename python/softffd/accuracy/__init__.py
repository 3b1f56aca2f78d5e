"""Measures error against run time."""
