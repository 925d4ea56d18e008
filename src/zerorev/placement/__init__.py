"""Where a part should stand, which of two robots should drill a hole, how far the tool stands off (thesis sec. 4.6)."""
