MODULE position_3
! --------------------------------------------------------------------------------------------------
! Written by zerorev golden
! Plan      position_3
! Robot     ABB stand-in (stand_in)
! Tool      thesis_drill
! Feeds     plunge 5 mm/s, retract 20 mm/s
! Spindle   3000 rev/min
! Blend     joint moves from 1 mm or less at the target
! Holes     1, with 0 joint reversals in all
! warning:  hole position 3: lead-in of 0.429 mm instead of 5 mm: further back A1 would turn the
!           other way
! info:     hole position 3: the blend of the joint moves (0.5 mm to either side, at most) turns
!           back 0.25 mm short (r/2, a parabolic blend; the controller's own curve may differ): the
!           hole comes out 0.25 mm less deep; deepen_corner places the corner that much deeper
! info:     the twist changes the speed of a right-hand drill by +0.689 rev/min at most (0.02% of
!           3000), in the lead-in of hole position 3
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
! - Start at the first line of position_3_run, by a call or with the program pointer there; never
!   from a line further down: what is set at the top holds for all.
! - After a stop in a hole jog the drill out along its axis, Z of position_3_tool, before a new
!   start: a MoveAbsJ comes first. If the controller then asks to regain the path, do not: move the
!   program pointer.
! - At the target MoveL hands over to two MoveAbsJ, which meet in a zone: no joint has to stop there
!   or turn round. Open: that none stops has not been seen on a controller. Watch the joints, and
!   the event log (50024, corner path failure: a zone became a stop).
! - position_3_tool has Z along the plunge and holds what the tool weighs; position_3_part is the
!   part frame. Do not correct it by hand for a part that was measured again: joint targets would
!   stay where they are.
! - Do not put z0, z1 or the like in the place of the zones: theirs are larger for the turn of the
!   tool than for its tip, and bring reversals back.
! - ConfL is off: a straight move continues in the posture that it begins in. Of a configuration's
!   last number the middle bit (wrist centre behind the lower arm) has not been compared with a
!   controller.
! --------------------------------------------------------------------------------------------------
PERS tooldata position_3_tool:=[TRUE,[[100.0000,0.0000,65.0000],[0.00000000,0.70710678,0.00000000,0.70710678]],[0.3000,[50.0000,0.0000,32.5000],[1,0,0,0],0.000000,0.000000,0.000000]];
PERS wobjdata position_3_part:=[FALSE,TRUE,"",[[0.0000,0.0000,0.0000],[1.00000000,0.00000000,0.00000000,0.00000000]],[[0,0,0],[1,0,0,0]]];
LOCAL CONST speeddata way_speed:=[250.0,45.0,5000,1000];
LOCAL CONST speeddata feed_5_000:=[5.000,500.0,5000,1000];
LOCAL CONST speeddata feed_20_000:=[20.000,500.0,5000,1000];
LOCAL CONST zonedata zone_0_2145:=[FALSE,0.2145,0.2145,0.2145,30.0,0.2145,0.2145];
LOCAL CONST zonedata zone_0_5000:=[FALSE,0.5000,0.5000,0.5000,30.0,0.5000,0.5000];
PROC position_3_run()
  ConfL\Off;
  ConfJ\On;
  SingArea\Off;
  PDispOff;
  EOffsOff;
  AccSet 100,100;
  VelSet 100,5000;
  ! Hole 1 of 1: position 3
  ! stroke 30.000 mm, lead-in 0.429 mm, reversals of A1 to A6: 0 0 0 0 0 0
  ! stand-off [mm] 30.429 30.000 1.000 0.000 1.000 30.000
  ! psi [deg] 20.5976 20.2431 -3.7211 -4.5475 -4.7189 -9.6903
  MoveAbsJ [[115.55936,-64.17913,-87.12054,12.78926,43.28831,236.50066],[9E9,9E9,9E9,9E9,9E9,9E9]],way_speed,fine,position_3_tool\WObj:=position_3_part;
  ! lead-in: start of the stroke
  MoveL [[170.0000,200.0000,1000.0000],[0.12426483,0.69610219,0.12426483,0.69610219],[1,0,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_0_2145,position_3_tool\WObj:=position_3_part;
  ! plunge: begin of the joint moves
  MoveL [[199.0000,200.0000,1000.0000],[-0.02295794,0.70673399,-0.02295794,0.70673399],[1,-1,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_0_5000,position_3_tool\WObj:=position_3_part;
  ! plunge: target
  MoveAbsJ [[115.22303,-75.22952,-81.44639,-2.05028,70.80279,245.52097],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000\T:=0.200000,zone_0_5000,position_3_tool\WObj:=position_3_part;
  ! retract: end of the joint moves
  MoveAbsJ [[114.95405,-75.23078,-81.43922,-2.10416,70.96204,245.80693],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_20_000\T:=0.050000,zone_0_5000,position_3_tool\WObj:=position_3_part;
  ! retract: end of the stroke
  MoveL [[170.0000,200.0000,1000.0000],[-0.05972441,0.70458001,-0.05972441,0.70458001],[1,-1,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_20_000,fine,position_3_tool\WObj:=position_3_part;
  ConfL\On;
ENDPROC
ENDMODULE
