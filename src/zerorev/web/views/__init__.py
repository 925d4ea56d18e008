"""The parts of the page: each draws what the session shows, and hands the user's wishes back to it."""
