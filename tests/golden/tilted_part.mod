MODULE tilted_part
! --------------------------------------------------------------------------------------------------
! Written by zerorev golden
! Plan      tilted part
! Robot     ABB stand-in (stand_in)
! Tool      thesis_drill
! Feeds     plunge 5 mm/s, retract 20 mm/s
! Spindle   not given
! Blend     2 mm at the target, corner placed deeper by the depth lost to the blend
! Holes     3, with 8 joint reversals in all
! info:     the blend of radius 2 mm turns back 1 mm short (r/2, a parabolic blend; the controller's
!           own curve may differ): the corner is placed that much deeper, so that the depth is met
!           (at every hole)
! warning:  the programmed corner lies 1 mm below the target; stopping or stepping there goes to the
!           true corner, so the clearance behind the material must allow it (at every hole)
! info:     the moves of all axes from hole to hole are checked against the surface of the part
!           alone, not for fixtures, the cell or the arm's own links; the first one, from wherever
!           the robot is, is not checked at all
! warning:  the corner is a zone between two MoveL that lead straight in and straight back: whether
!           an ABB passes it without a stop of all joints is not known; try it in RobotStudio, or
!           plan with corner: joint
!
! - Run the program in manual mode at reduced speed first, the spindle off and no part in place.
! - MoveAbsJ between holes are checked against the surface of the part alone, and the first one not
!   at all: not for fixtures, the cell or the arm's own links.
! - Spindle and coolant are not set here. The spindle must run before the drill enters.
! - The work object is given from the robot's base: it holds where the base frame is not moved in
!   the world.
! - Start at the first line of tilted_part_run, by a call or with the program pointer there; never
!   from a line further down: what is set at the top holds for all.
! - After a stop in a hole jog the drill out along its axis, Z of tilted_part_tool, before a new
!   start: a MoveAbsJ comes first. If the controller then asks to regain the path, do not: move the
!   program pointer.
! - At the target two MoveL, straight in and straight back, meet in a zone. Open: whether a
!   controller takes that without a stop of all joints, and how deep. Try it in RobotStudio first;
!   corner: joint avoids it.
! - tilted_part_tool has Z along the plunge and holds what the tool weighs; tilted_part_part is the
!   part frame. Do not correct it by hand for a part that was measured again: joint targets would
!   stay where they are.
! - Do not put z0, z1 or the like in the place of the zones: theirs are larger for the turn of the
!   tool than for its tip, and bring reversals back.
! - ConfL is off: a straight move continues in the posture that it begins in. Of a configuration's
!   last number the middle bit (wrist centre behind the lower arm) has not been compared with a
!   controller.
! --------------------------------------------------------------------------------------------------
PERS tooldata tilted_part_tool:=[TRUE,[[100.0000,0.0000,65.0000],[0.00000000,0.70710678,0.00000000,0.70710678]],[0.3000,[50.0000,0.0000,32.5000],[1,0,0,0],0.000000,0.000000,0.000000]];
PERS wobjdata tilted_part_part:=[FALSE,TRUE,"",[[400.0000,-100.0000,300.0000],[0.96592583,0.00000000,0.25881905,0.00000000]],[[0,0,0],[1,0,0,0]]];
LOCAL CONST speeddata way_speed:=[250.0,45.0,5000,1000];
LOCAL CONST speeddata feed_5_000:=[5.000,500.0,5000,1000];
LOCAL CONST speeddata feed_20_000:=[20.000,500.0,5000,1000];
LOCAL CONST zonedata zone_1_5000:=[FALSE,1.5000,1.5000,1.5000,30.0,1.5000,1.5000];
LOCAL CONST zonedata zone_2_0000:=[FALSE,2.0000,2.0000,2.0000,30.0,2.0000,2.0000];
PROC tilted_part_run()
  ConfL\Off;
  ConfJ\On;
  SingArea\Off;
  PDispOff;
  EOffsOff;
  AccSet 100,100;
  VelSet 100,5000;
  ! Hole 1 of 3: position 1
  ! stroke 50.000 mm, lead-in 3.000 mm, reversals of A1 to A6: 0 0 0 0 0 0
  ! stand-off [mm] 53.000 50.000 -1.000 50.000
  ! psi [deg] 15.3472 14.1646 -5.9388 -30.4599
  MoveAbsJ [[143.26490,-107.15440,-79.88926,12.25522,87.77327,217.25377],[9E9,9E9,9E9,9E9,9E9,9E9]],way_speed,fine,tilted_part_tool\WObj:=tilted_part_part;
  ! lead-in: start of the stroke
  MoveL [[-206.6987,400.0000,458.0127],[0.10677653,0.49618504,0.06164746,0.85941769],[1,0,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_1_5000,tilted_part_tool\WObj:=tilted_part_part;
  ! plunge: corner, 1 mm below the target
  MoveL [[-162.5314,400.0000,483.5127],[-0.04486238,0.49932867,-0.02590130,0.86486263],[1,-1,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_2_0000,tilted_part_tool\WObj:=tilted_part_part;
  ! retract: end of the stroke
  MoveL [[-206.6987,400.0000,458.0127],[-0.22749932,0.48243965,-0.13134679,0.83560999],[1,-1,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_20_000,fine,tilted_part_tool\WObj:=tilted_part_part;
  ! Hole 2 of 3: position 2
  ! stroke 20.000 mm, lead-in 3.000 mm, reversals of A1 to A6: 1 2 2 0 0 0
  ! stand-off [mm] 23.000 20.000 -1.000 20.000
  ! psi [deg] 180.2714 180.0000 178.1001 142.4918
  MoveAbsJ [[-79.12334,-86.95713,87.66785,0.05122,89.55582,100.87615],[9E9,9E9,9E9,9E9,9E9,9E9]],way_speed,fine,tilted_part_tool\WObj:=tilted_part_part;
  ! lead-in: start of the stroke
  MoveL [[-340.5256,500.0000,149.8076],[0.86602540,0.00000000,0.50000000,0.00000000],[-1,0,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_1_5000,tilted_part_tool\WObj:=tilted_part_part;
  ! plunge: corner, 1 mm below the target
  MoveL [[-322.3391,500.0000,160.3076],[0.86590638,0.00828950,0.49993128,0.01435783],[-1,-1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_2_0000,tilted_part_tool\WObj:=tilted_part_part;
  ! retract: end of the stroke
  MoveL [[-340.5256,500.0000,149.8076],[0.82004563,0.16075361,0.47345356,0.27843342],[-1,-1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_20_000,fine,tilted_part_tool\WObj:=tilted_part_part;
  ! Hole 3 of 3: position 3
  ! stroke 30.000 mm, lead-in 3.000 mm, reversals of A1 to A6: 1 2 0 0 0 0
  ! stand-off [mm] 33.000 30.000 -1.000 30.000
  ! psi [deg] 22.6422 20.2431 -4.5475 -9.6903
  MoveAbsJ [[-136.31631,-81.11646,86.29162,30.34681,60.63480,34.26948],[9E9,9E9,9E9,9E9,9E9,9E9]],way_speed,fine,tilted_part_tool\WObj:=tilted_part_part;
  MoveAbsJ [[23.03709,-96.77137,-59.45143,-24.32139,59.33813,348.24151],[9E9,9E9,9E9,9E9,9E9,9E9]],way_speed,fine,tilted_part_tool\WObj:=tilted_part_part;
  MoveAbsJ [[115.52214,-63.43693,-87.17894,14.66733,40.92567,235.03293],[9E9,9E9,9E9,9E9,9E9,9E9]],way_speed,fine,tilted_part_tool\WObj:=tilted_part_part;
  ! lead-in: start of the stroke
  MoveL [[-549.1858,300.0000,491.2178],[0.15219271,0.49221858,0.08786850,0.85254758],[1,0,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_1_5000,tilted_part_tool\WObj:=tilted_part_part;
  ! plunge: corner, 1 mm below the target
  MoveL [[-522.3391,300.0000,506.7178],[-0.03435870,0.49960634,-0.01983700,0.86534356],[1,-1,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_5_000,zone_2_0000,tilted_part_tool\WObj:=tilted_part_part;
  ! retract: end of the stroke
  MoveL [[-549.1858,300.0000,491.2178],[-0.07314716,0.49821331,-0.04223153,0.86293076],[1,-1,2,4],[9E9,9E9,9E9,9E9,9E9,9E9]],feed_20_000,fine,tilted_part_tool\WObj:=tilted_part_part;
  ConfL\On;
ENDPROC
ENDMODULE
