"""What a motion does: kinematics, the joint path, evaluation, criteria, critical rates."""
