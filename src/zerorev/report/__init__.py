"""What a plan looks like: figures for people."""
