"""Re-checks a plan from the model alone, sharing no code with the search."""

from zerorev.verify.check import verify_hole, verify_plan

__all__ = ["verify_hole", "verify_plan"]
