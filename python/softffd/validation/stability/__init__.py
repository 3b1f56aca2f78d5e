"""Stiff and extreme scenes."""
