"""Frozen nouns, validated when made: robot, tool, hole, job, settings, profile, motion, plan, finding."""
