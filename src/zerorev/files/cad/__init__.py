"""Holes and shapes out of CAD files: STEP, DXF, STL."""
