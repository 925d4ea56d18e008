"""Maps: an objective looked at everywhere on a grid, kept with its coordinates."""
