"""Arrays in, arrays out: plain functions compiled by numba, fixed shapes, NaN where there is no answer."""
