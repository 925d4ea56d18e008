"""Proofs of optimality, checked in ball arithmetic."""
