"""The physics: dynamics, plant, controller, lost motion, ensembles, recordings."""
