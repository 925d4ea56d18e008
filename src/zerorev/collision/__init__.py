"""Shapes on the arm, and how near they come to the part: found, and proven for all that lies between what was tried."""
