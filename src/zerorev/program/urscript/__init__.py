"""URScript: words, writing and reading of programs for controllers of Universal Robots."""
