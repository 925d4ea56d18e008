"""Plans: of one hole, of a whole job, and both again from a plan file."""
