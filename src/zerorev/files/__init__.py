"""Text to nouns and back: job, plan, map, table (CSV, pasted), URDF; robots and tools that ship, as data."""
