"""Re-checks a plan from the model alone, sharing no code with the search."""
