MODULE position_2
! --------------------------------------------------------------------------------------------------
! Written by zerorev golden
! Plan      position_2
! Robot     ABB stand-in (stand_in)
! Tool      thesis_drill
! Feeds     plunge 5 mm/s, retract 20 mm/s
! Spindle   3000 rev/min
! Blend     joint moves from 1 mm or less at the target
! Holes     1, with 0 joint reversals in all
! info:     hole position 2: the blend of the joint moves (0.5 mm to either side, at most) turns
!           back 0.25 mm short (r/2, a parabolic blend; the controller's own curve may differ): the
!           hole comes out 0.25 mm less deep; deepen_corner places the corner that much deeper
! info:     the twist changes the speed of a right-hand drill by +5.93 rev/min at most (0.20% of
!           3000), in the retract of hole position 2
! info:     the moves of all axes from hole to hole are checked against the surface of the part
!           alone, not for fixtures, the cell or the arm's own links; the first one, from wherever
!           the robot is, is not checked at all
!
! - Run the program in manual mode at reduced speed first, the spindle off and no part in place.
! - MoveAbsJ between holes are checked against the surface of the part alone, and the first one not
!   at all: not for fixtures, the cell or the arm's own links.
! - Spindle and coolant are not set here. The spindle must run before the drill enters.
! - The work object is given from the robot's base: it holds where the base frame is not moved in
!   the world.
! - Start at the first line of position_2_run, by a call or with the program pointer there; never
!   from a line further down: what is set at the top holds for all.
! - After a stop in a hole jog the drill out along its axis, Z of position_2_tool, before a new
!   start: a MoveAbsJ comes first. If the controller then asks to regain the path, do not: move the
!   program pointer.
! - At the target MoveL hands over to two MoveAbsJ, which meet in a zone: no joint has to stop there
!   or turn round. Open: that none stops has not been seen on a controller. Watch the joints, and
!   the event log (50024, corner path failure: a zone became a stop).
! - position_2_tool has Z along the plunge and holds what the tool weighs; position_2_part is the
!   part frame. Do not correct it by hand for a part that was measured again: joint targets would
!   stay where they are.
! - Do not put z0, z1 or the like in the place of the zones: theirs are larger for the turn of the
!   tool than for its tip, and bring reversals back.
! - ConfL is off: a straight move continues in the posture that it begins in. Of a configuration's
!   last number the middle bit (wrist centre behind the lower arm) has not been compared with a
!   controller.
! --------------------------------------------------------------------------------------------------
PERS tooldata position_2_tool:=[TRUE,[[100.0000,0.0000,65.0000],[0.00000000,0.70710678,0.00000000,0.70710678]],[0.3000,[50.0000,0.0000,32.5000],[1,0,0,0],0.000000,0.000000,0.000000]];
PERS wobjdata position_2_part:=[FALSE,TRUE,"",[[0.0000,0.0000,0.0000],[1.00000000,0.00000000,0.00000000,0.00000000]],[[0,0,0],[1,0,0,0]]];
LOCAL CONST speeddata way_speed:=[250.0,45.0,5000,1000];
LOCAL CONST speeddata feed_5_000:=[5.000,500.0,5000,1000];
LOCAL CONST speeddata feed_20_000:=[20.000,500.0,5000,1000];
LOCAL CONST zonedata zone_1_0000:=[FALSE,1.0000,1.0000,1.0000,30.0,1.0000,1.0000];
LOCAL CONST zonedata zone_0_5000:=[FALSE,0.5000,0.5000,0.5000,30.0,0.5000,0.5000];
PROC position_2_run()
  ConfL\Off;
  ConfJ\On;
  SingArea\Off;
  PDispOff;
  EOffsOff;
  AccSet 100,100;
  VelSet 100,5000;
  ! Hole 1 of 1: position 2
  ! stroke 20.000 mm, lead-in 5.000 mm, reversals of A1 to A6: 0 0 0 0 0 0
  ! stand-off [mm] 25.000 20.000 1.000 0.000 1.000 20.000
  ! psi [deg] 180.4750 180.0000 178.1951 178.1001 176.3197 142.4918
  MoveAbsJ [[-79.41358,-86.92820,87.63807,0.08726,89.75702,100.58570],[9E9,9E9,9E9,9E9,9E9,9E9]],way_speed,fine,position_2_tool\WObj:=position_2_part;
  ! lead-in: start of the stroke
  MoveL [[180.0000,400.0000,600.0000],[0.70710678,0.00000000,0.70710678,0.00000000],[-1,0,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_1_0000,position_2_tool\WObj:=position_2_part;
  ! plunge: begin of the joint moves
  MoveL [[199.0000,400.0000,600.0000],[0.70701907,0.01113701,0.70701907,0.01113701],[-1,-1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_0_5000,position_2_tool\WObj:=position_2_part;
  ! plunge: target
  MoveAbsJ [[-75.78844,-87.08465,87.81454,-0.46682,87.42840,104.22501],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000\T:=0.200000,zone_0_5000,position_2_tool\WObj:=position_2_part;
  ! retract: end of the joint moves
  MoveAbsJ [[-75.75831,-87.92925,88.72961,-0.90745,85.63269,104.28262],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_20_000\T:=0.050000,zone_0_5000,position_2_tool\WObj:=position_2_part;
  ! retract: end of the stroke
  MoveL [[180.0000,400.0000,600.0000],[0.66956445,0.22733994,0.66956445,0.22733994],[-1,-1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_20_000,fine,position_2_tool\WObj:=position_2_part;
  ConfL\On;
ENDPROC
ENDMODULE
