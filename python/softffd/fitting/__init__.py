"""Fits parameters to measured curves."""
