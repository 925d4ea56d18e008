"""How much better a motion could be at all: a global search that bounds (theory §3)."""
