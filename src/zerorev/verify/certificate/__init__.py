"""Proofs in ball arithmetic: of a plan, of a program, of every placement within a tolerance."""
