"""What the program measures of itself: accuracy, stability, and the numpy twin."""
