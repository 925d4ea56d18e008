"""What the terminal and the tables say."""
