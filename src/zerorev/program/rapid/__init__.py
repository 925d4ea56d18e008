"""RAPID: words, writing and reading of programs for ABB controllers."""
