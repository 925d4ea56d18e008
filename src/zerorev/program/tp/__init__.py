"""TP: words, writing and reading of programs for FANUC controllers, as ASCII (.ls)."""
