"""Neutral program, preflight, and one file a controller."""
