"""Figures of the thesis' method: swarms, comparisons, the parameter map, the published curves again."""
