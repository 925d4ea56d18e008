"""Frozen nouns, validated when made: robot, tool, hole, job, profile, plan, and their files."""
