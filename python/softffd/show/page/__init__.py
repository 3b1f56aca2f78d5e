"""The files of the interactive page: its frame with the style, its shaders and its scripts, which `view.py` puts together."""
