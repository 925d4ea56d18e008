"""What a person looks at: figures, the scene behind pictures and player, words."""
