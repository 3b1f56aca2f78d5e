"""The shipped scenes."""
