"""Which motion is best: exact search, bounds, free legs, depth, prediction; `rank` is the one order of motions."""
