"""Recordings of runs: read and written in the formats of controllers, aligned, measured, compared; a recorder."""
