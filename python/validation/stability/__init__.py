"""Stability survey: runs of stiff and extreme scenes."""
