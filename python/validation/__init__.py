"""Checks of the program against independent references: accuracy, stability, published cases and the numpy twin."""
