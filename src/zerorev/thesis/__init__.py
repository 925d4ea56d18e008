"""The thesis' own method and its reproduction: swarm and peers, sampled objective, parameter map, figures."""
