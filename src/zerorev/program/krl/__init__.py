"""KRL: words, writing and reading of programs for KUKA controllers."""
