"""The data behind pictures: the robot and its cell, the twist plane, the player."""
