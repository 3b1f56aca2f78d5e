"""The files of the interactive page: its HTML frame with the style, its shaders and its scripts, which `view.py` combines."""
