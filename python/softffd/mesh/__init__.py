"""Mesh files: read, checked, written."""
