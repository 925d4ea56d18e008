"""One file a method of finding the best motion of a hole."""
