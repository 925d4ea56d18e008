"""Where a part should stand, so that every hole of its pattern is drilled without a reversal (thesis sec. 4.6)."""
