"""Names in URScript: what is a word of the language, or a function that every controller has."""

from __future__ import annotations

from zerorev.program.names import WINDOWS, Names

__all__ = ["KEPT", "URSCRIPT_NAMES"]

_LANGUAGE = """
and break continue def elif else end enter_critical exit_critical False for global halt if in join kill let local loop
MAX MIN not or p part pause PI popup return run sec struct switch sync then thread to True while xor
"""
_MOTION = """
conveyor_pulse_decode encoder_enable_pulse_decode encoder_enable_set_tick_count encoder_get_tick_count
encoder_set_tick_count encoder_unwind_delta_tick_count end_force_mode end_freedrive_mode end_screw_driving
end_teach_mode force_mode force_mode_set_damping force_mode_set_gain_scaling freedrive_mode get_conveyor_tick_count
get_freedrive_status get_target_tcp_pose_along_path get_target_tcp_speed_along_path movec movej movel movep
path_offset_disable path_offset_enable path_offset_get path_offset_set path_offset_set_alpha_filter
path_offset_set_max_offset pause_on_error_code position_deviation_warning reset_revolution_counter screw_driving
servoc servoj servol set_conveyor_tick_count set_pos sleep speedj speedl stop_conveyor_tracking stopj stopl teach_mode
track_conveyor_circular track_conveyor_linear
"""
_SETTINGS = """
set_gravity set_payload set_payload_cog set_payload_mass set_safety_mode_transition_hardness set_target_payload
set_tcp
"""
_VALUES = """
acos asin atan atan2 binary_list_to_integer ceil cos d2r floor force get_actual_joint_positions
get_actual_joint_speeds get_actual_tcp_pose get_actual_tcp_speed get_controller_temp get_forward_kin get_inverse_kin
get_inverse_kin_has_solution get_joint_temp get_joint_torques get_list_length get_steptime get_target_joint_positions
get_target_joint_speeds get_target_payload_cog get_target_payload_inertia get_target_payload_mass get_target_tcp_pose
get_target_tcp_speed get_target_waypoint get_tcp_force get_tcp_offset get_tool_accelerometer_reading get_tool_current
integer_to_binary_list interpolate_pose inv is_steady is_within_safety_limits length log norm normalize point_dist
pose_add pose_dist pose_inv pose_sub pose_trans pow powerdown r2d random rotvec2rpy rpy2rotvec sin size sqrt
str_at str_cat str_empty str_find str_len str_sub tan textmsg to_num to_str transpose wrench_trans
"""
KEPT = frozenset(f"{_LANGUAGE} {_MOTION} {_SETTINGS}".split())
"""Words of the language, and functions that move the robot, let it stand or change how it moves: what no call may be
called."""

URSCRIPT_NAMES = Names(32, frozenset(name.upper() for name in KEPT | frozenset(_VALUES.split())) | WINDOWS)
"""No greatest length is documented; these stay readable on the pendant."""
