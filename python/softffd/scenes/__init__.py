"""The shipped scenes; where several are about one thing, they have a folder with the files that they share."""
