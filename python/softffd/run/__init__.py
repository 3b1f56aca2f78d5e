"""Runs, their inputs and results."""
