/PROG  P_FATJ2X
/ATTR
COMMENT		= "zerorev drilling";
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
   1:  ! ------------------------------- ;
   2:  ! Written by zerorev golden ;
   3:  ! Plan position_1 ;
   4:  ! Robot FANUC LR Mate 200iD ;
   5:  !  (fanuc_lrmate200id) ;
   6:  ! Tool thesis_drill ;
   7:  ! Feeds plunge 5 mm/s, retract 20 ;
   8:  !  mm/s ;
   9:  ! Spindle 3000 rev/min ;
  10:  ! Blend joint moves from 1 mm or ;
  11:  !  less at the target ;
  12:  ! Holes 1, with 0 joint reversals ;
  13:  !  in all ;
  14:  ! info: hole position 1: the ;
  15:  !  blend of the joint moves (0.5 ;
  16:  !  mm to either side, at most) ;
  17:  !  turns back 0.25 mm short (r/2, ;
  18:  !  a parabolic blend over half of ;
  19:  !  each joint move, how far the ;
  20:  !  controller blends is not in ;
  21:  !  the program): the hole comes ;
  22:  !  out 0.25 mm less deep, ;
  23:  !  deepen_corner places the ;
  24:  !  corner that much deeper ;
  25:  ! info: the twist changes the ;
  26:  !  speed of a right-hand drill by ;
  27:  !  +1.68 rev/min at most (0.06% ;
  28:  !  of 3000), in the retract of ;
  29:  !  hole position 1 ;
  30:  ! info: the moves of all axes ;
  31:  !  from hole to hole are checked ;
  32:  !  against the surface of the ;
  33:  !  part alone, not for fixtures, ;
  34:  !  the cell or the arm's own ;
  35:  !  links, the first one, from ;
  36:  !  wherever the robot is, is not ;
  37:  !  checked at all ;
  38:  ! ;
  39:  ! - Run the program in T1 first, ;
  40:  !  the spindle off and no part in ;
  41:  !  place. ;
  42:  ! - UTOOL 3 is selected, not set. ;
  43:  !  It must hold X 100.000, Y ;
  44:  !  0.000, Z 65.000, W 180.000, P ;
  45:  !  -90.000, R 0.000 (flange to ;
  46:  !  tip, Z along the plunge). ;
  47:  ! - UFRAME 0: points are given in ;
  48:  !  the world frame, which counts ;
  49:  !  Z from the height of axis 2. ;
  50:  ! - J3 is printed as the pendant ;
  51:  !  shows it: its angle against ;
  52:  !  the ground. ;
  53:  ! - Spindle, coolant and PAYLOAD ;
  54:  !  are not set here. The spindle ;
  55:  !  must run before the drill ;
  56:  !  enters. ;
  57:  ! - J moves at 20 % are checked ;
  58:  !  against the surface of the ;
  59:  !  part alone, and the first one ;
  60:  !  not at all: not for fixtures, ;
  61:  !  the cell or the arm's own ;
  62:  !  links. ;
  63:  ! - Start at line 1: the numbers ;
  64:  !  of the frames are set there. ;
  65:  ! - After a stop in a hole pull ;
  66:  !  the drill out along the drill ;
  67:  !  axis (tool Z) before a new ;
  68:  !  start: a J comes first. ;
  69:  ! - The last of the plunge and ;
  70:  !  the first of the retract are J ;
  71:  !  moves by time (msec), blended ;
  72:  !  with CNT100. How far CNT ;
  73:  !  reaches depends on speed, ;
  74:  !  acceleration and override and ;
  75:  !  is not known: 0 to 1 mm of ;
  76:  !  depth are lost there, at every ;
  77:  !  override. Measure at the ;
  78:  !  override with which you drill. ;
  79:  ! - Open, not tried on a ;
  80:  !  controller: CNT100 from L to J ;
  81:  !  and back, moves of a few ms, ;
  82:  !  the letters of CONFIG. If an L ;
  83:  !  stops with a position or ;
  84:  !  configuration alarm, stop ;
  85:  !  there. ;
  86:  ! ------------------------------- ;
  87:  UFRAME_NUM=0 ;
  88:  UTOOL_NUM=3 ;
  89:  ! Hole 1 of 1: position 1 ;
  90:  ! stroke 50.000 mm, lead-in 5.000 ;
  91:  ! mm, reversals of J1 to J6: 0 0 ;
  92:  ! 0 0 0 0 ;
  93:  ! stand-off [mm] 55.000 50.000 ;
  94:  ! 1.000 0.000 1.000 50.000 ;
  95:  ! psi [deg] 11.3811 9.5194 ;
  96:  ! -8.7258 -9.0982 -9.6032 ;
  97:  ! -34.3509 ;
  98:  ! P[1] start, P[2] start of the ;
  99:  ! stroke, P[3] begin of the joint ;
 100:  ! moves, P[4] target, P[5] end of ;
 101:  ! the joint moves, P[6] end of ;
 102:  ! the stroke ;
 103:J P[1] 20% FINE    ;
 104:L P[2] 5mm/sec CNT100    ;
 105:L P[3] 5mm/sec CNT100    ;
 106:J P[4] 200msec CNT100    ;
 107:J P[5] 50msec CNT100    ;
 108:L P[6] 20mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -141.314 deg,	J2=   -22.158 deg,	J3=   176.864 deg,
	J4=   189.004 deg,	J5=    79.818 deg,	J6=  -142.362 deg
};
P[2]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, 1, 0, 0',
	X =   425.721  mm,	Y =   285.433  mm,	Z =   431.154  mm,
	W =    90.000 deg,	P =   -80.481 deg,	R =    90.000 deg
};
P[3]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, 0, 0, 0',
	X =   474.721  mm,	Y =   285.433  mm,	Z =   431.154  mm,
	W =   -90.000 deg,	P =   -81.274 deg,	R =   -90.000 deg
};
P[4]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -140.624 deg,	J2=   -37.352 deg,	J3=   169.668 deg,
	J4=   172.957 deg,	J5=    85.503 deg,	J6=  -139.712 deg
};
P[5]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -140.434 deg,	J2=   -37.362 deg,	J3=   169.626 deg,
	J4=   172.591 deg,	J5=    85.812 deg,	J6=  -139.492 deg
};
P[6]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, 0, 0, 0',
	X =   425.721  mm,	Y =   285.433  mm,	Z =   431.154  mm,
	W =   -90.000 deg,	P =   -55.649 deg,	R =   -90.000 deg
};
/END
