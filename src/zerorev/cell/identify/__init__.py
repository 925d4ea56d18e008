"""From recordings of an arm to the ranges of its parameters: fitted, conditioned, or still a guess."""
