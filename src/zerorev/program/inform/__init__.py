"""INFORM: words, writing and reading of jobs for Yaskawa controllers."""
