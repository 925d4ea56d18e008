/PROG  FREE
/ATTR
COMMENT		= "zerorev drilling";
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
   1:  ! ------------------------------- ;
   2:  ! Written by zerorev golden ;
   3:  ! Plan free_leg ;
   4:  ! Robot FANUC LR Mate 200iD ;
   5:  !  (fanuc_lrmate200id) ;
   6:  ! Tool thesis_drill ;
   7:  ! Feeds plunge 4.5 mm/s, retract ;
   8:  !  20 mm/s ;
   9:  ! Spindle not given ;
  10:  ! Blend joint moves from 1 mm or ;
  11:  !  less at the target ;
  12:  ! Holes 1, with 0 joint reversals ;
  13:  !  in all ;
  14:  ! info: hole position 2: the ;
  15:  !  blend of the joint moves ;
  16:  !  (0.4165 mm to either side, at ;
  17:  !  most) turns back 0.2082 mm ;
  18:  !  short (r/2, a parabolic blend ;
  19:  !  over half of each joint move, ;
  20:  !  how far the controller blends ;
  21:  !  is not in the program): the ;
  22:  !  hole comes out 0.2082 mm less ;
  23:  !  deep, deepen_corner places the ;
  24:  !  corner that much deeper ;
  25:  ! warning: 5 linear moves last ;
  26:  !  less than two cycles of a ;
  27:  !  controller (24 ms): 20.8 ms ;
  28:  !  for 0.417 mm at 20 mm/s in the ;
  29:  !  retract of hole position 2, ;
  30:  !  the feed may drop. A lower ;
  31:  !  feed, a longer stroke or ;
  32:  !  lead-in, or fewer breakpoints ;
  33:  !  make them longer ;
  34:  ! info: the moves of all axes ;
  35:  !  from hole to hole are checked ;
  36:  !  against the surface of the ;
  37:  !  part alone, not for fixtures, ;
  38:  !  the cell or the arm's own ;
  39:  !  links, the first one, from ;
  40:  !  wherever the robot is, is not ;
  41:  !  checked at all ;
  42:  ! info: a feed of 20 mm/s over ;
  43:  !  0.833 mm is written as 42msec, ;
  44:  !  which is 19.83 mm/s, of 2 such ;
  45:  !  changes at the corner the ;
  46:  !  greatest ;
  47:  ! ;
  48:  ! - Run the program in T1 first, ;
  49:  !  the spindle off and no part in ;
  50:  !  place. ;
  51:  ! - UTOOL 3 is selected, not set. ;
  52:  !  It must hold X 100.000, Y ;
  53:  !  0.000, Z 65.000, W 180.000, P ;
  54:  !  -90.000, R 0.000 (flange to ;
  55:  !  tip, Z along the plunge). ;
  56:  ! - UFRAME 2 is selected, not ;
  57:  !  set. It must hold X 400.000, Y ;
  58:  !  -100.000, Z -30.000, W 0.000, ;
  59:  !  P 0.000, R 90.000, given in ;
  60:  !  the world frame, which counts ;
  61:  !  Z from the height of axis 2. ;
  62:  !  Do not correct it for a part ;
  63:  !  that was measured again: J ;
  64:  !  moves would stay where they ;
  65:  !  are. Plan again. ;
  66:  ! - J3 is printed as the pendant ;
  67:  !  shows it: its angle against ;
  68:  !  the ground. ;
  69:  ! - Spindle, coolant and PAYLOAD ;
  70:  !  are not set here. The spindle ;
  71:  !  must run before the drill ;
  72:  !  enters. ;
  73:  ! - J moves at 20 % are checked ;
  74:  !  against the surface of the ;
  75:  !  part alone, and the first one ;
  76:  !  not at all: not for fixtures, ;
  77:  !  the cell or the arm's own ;
  78:  !  links. ;
  79:  ! - Start at line 1: the numbers ;
  80:  !  of the frames are set there. ;
  81:  ! - After a stop in a hole pull ;
  82:  !  the drill out along the drill ;
  83:  !  axis (tool Z) before a new ;
  84:  !  start: a J comes first. ;
  85:  ! - The last of the plunge and ;
  86:  !  the first of the retract are J ;
  87:  !  moves by time (msec), blended ;
  88:  !  with CNT100. How far CNT ;
  89:  !  reaches depends on speed, ;
  90:  !  acceleration and override and ;
  91:  !  is not known: 0 to 1 mm of ;
  92:  !  depth are lost there, at every ;
  93:  !  override. Measure at the ;
  94:  !  override with which you drill. ;
  95:  ! - Open, not tried on a ;
  96:  !  controller: CNT100 from L to J ;
  97:  !  and back, moves of a few ms, ;
  98:  !  the letters of CONFIG. If an L ;
  99:  !  stops with a position or ;
 100:  !  configuration alarm, stop ;
 101:  !  there. ;
 102:  ! ------------------------------- ;
 103:  UFRAME_NUM=2 ;
 104:  UTOOL_NUM=3 ;
 105:  ! Hole 1 of 1: position 2 ;
 106:  ! stroke 20.000 mm, lead-in 5.000 ;
 107:  ! mm, reversals of J1 to J6: 0 0 ;
 108:  ! 0 0 0 0 ;
 109:  ! stand-off [mm] 25.000 20.000 ;
 110:  ! 17.917 15.417 12.917 10.417 ;
 111:  ! 8.333 7.917 7.500 7.083 6.667 ;
 112:  ! 6.250 5.833 5.417 5.000 4.583 ;
 113:  ! 2.500 0.833 0.000 0.833 1.667 ;
 114:  ! 3.750 6.250 8.750 9.167 9.583 ;
 115:  ! 10.000 10.417 11.667 13.333 ;
 116:  ! 15.000 16.667 17.917 18.750 ;
 117:  ! 19.583 20.000 ;
 118:  ! psi [deg] -177.1776 -177.6836 ;
 119:  ! -177.8944 -178.1531 -178.4174 ;
 120:  ! -178.6874 -178.9162 -178.9621 ;
 121:  ! -179.0082 -179.0544 -179.1008 ;
 122:  ! -179.1473 -179.1940 -179.2408 ;
 123:  ! -179.2878 -179.3349 -179.5743 ;
 124:  ! -179.7701 -179.8680 -181.6745 ;
 125:  ! -183.4824 -187.1943 -191.6887 ;
 126:  ! -196.2539 -197.0173 -197.7834 ;
 127:  ! -198.5524 -199.3244 -201.6714 ;
 128:  ! -204.8674 -208.1465 -211.5284 ;
 129:  ! -214.1346 -215.9076 -217.7206 ;
 130:  ! -218.6379 ;
 131:  ! P[1] start, P[2] start of the ;
 132:  ! stroke, P[3] breakpoint, P[4] ;
 133:  ! breakpoint, P[5] breakpoint, ;
 134:  ! P[6] breakpoint, P[7] ;
 135:  ! breakpoint, P[8] breakpoint, ;
 136:  ! P[9] breakpoint, P[10] ;
 137:  ! breakpoint, P[11] breakpoint, ;
 138:  ! P[12] breakpoint, P[13] ;
 139:  ! breakpoint, P[14] breakpoint, ;
 140:  ! P[15] breakpoint, P[16] ;
 141:  ! breakpoint, P[17] breakpoint, ;
 142:  ! P[18] begin of the joint moves, ;
 143:  ! P[19] target, P[20] end of the ;
 144:  ! joint moves, P[21] breakpoint, ;
 145:  ! P[22] breakpoint, P[23] ;
 146:  ! breakpoint, P[24] breakpoint, ;
 147:  ! P[25] breakpoint, P[26] ;
 148:  ! breakpoint, P[27] breakpoint, ;
 149:  ! P[28] breakpoint, P[29] ;
 150:  ! breakpoint, P[30] breakpoint, ;
 151:  ! P[31] breakpoint, P[32] ;
 152:  ! breakpoint, P[33] breakpoint, ;
 153:  ! P[34] breakpoint, P[35] ;
 154:  ! breakpoint, P[36] end of the ;
 155:  ! stroke ;
 156:J P[1] 20% FINE    ;
 157:L P[2] 27cm/min CNT100    ;
 158:L P[3] 27cm/min CNT100    ;
 159:L P[4] 27cm/min CNT100    ;
 160:L P[5] 27cm/min CNT100    ;
 161:L P[6] 27cm/min CNT100    ;
 162:L P[7] 27cm/min CNT100    ;
 163:L P[8] 27cm/min CNT100    ;
 164:L P[9] 27cm/min CNT100    ;
 165:L P[10] 27cm/min CNT100    ;
 166:L P[11] 27cm/min CNT100    ;
 167:L P[12] 27cm/min CNT100    ;
 168:L P[13] 27cm/min CNT100    ;
 169:L P[14] 27cm/min CNT100    ;
 170:L P[15] 27cm/min CNT100    ;
 171:L P[16] 27cm/min CNT100    ;
 172:L P[17] 27cm/min CNT100    ;
 173:L P[18] 27cm/min CNT100    ;
 174:J P[19] 185msec CNT100    ;
 175:J P[20] 42msec CNT100    ;
 176:L P[21] 20mm/sec CNT100    ;
 177:L P[22] 20mm/sec CNT100    ;
 178:L P[23] 20mm/sec CNT100    ;
 179:L P[24] 20mm/sec CNT100    ;
 180:L P[25] 20mm/sec CNT100    ;
 181:L P[26] 20mm/sec CNT100    ;
 182:L P[27] 20mm/sec CNT100    ;
 183:L P[28] 20mm/sec CNT100    ;
 184:L P[29] 20mm/sec CNT100    ;
 185:L P[30] 20mm/sec CNT100    ;
 186:L P[31] 20mm/sec CNT100    ;
 187:L P[32] 20mm/sec CNT100    ;
 188:L P[33] 20mm/sec CNT100    ;
 189:L P[34] 20mm/sec CNT100    ;
 190:L P[35] 20mm/sec CNT100    ;
 191:L P[36] 20mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 2, UT : 3,	
	J1=    80.442 deg,	J2=     1.913 deg,	J3=     3.584 deg,
	J4=   180.471 deg,	J5=    96.367 deg,	J6=    99.599 deg
};
P[2]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   229.711  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    87.684 deg,	R =   180.000 deg
};
P[3]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   227.628  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    87.894 deg,	R =   180.000 deg
};
P[4]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   225.128  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    88.153 deg,	R =   180.000 deg
};
P[5]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   222.628  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    88.417 deg,	R =   180.000 deg
};
P[6]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   220.128  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    88.687 deg,	R =   180.000 deg
};
P[7]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   218.045  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    88.916 deg,	R =   180.000 deg
};
P[8]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   217.628  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    88.962 deg,	R =   180.000 deg
};
P[9]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   217.211  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.008 deg,	R =   180.000 deg
};
P[10]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   216.795  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.054 deg,	R =   180.000 deg
};
P[11]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   216.378  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.101 deg,	R =   180.000 deg
};
P[12]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   215.961  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.147 deg,	R =   180.000 deg
};
P[13]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   215.545  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.194 deg,	R =   180.000 deg
};
P[14]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   215.128  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.241 deg,	R =   180.000 deg
};
P[15]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   214.711  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.288 deg,	R =   180.000 deg
};
P[16]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   214.295  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.335 deg,	R =   180.000 deg
};
P[17]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   212.211  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.574 deg,	R =   180.000 deg
};
P[18]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   480.577  mm,	Y =   210.544  mm,	Z =   270.866  mm,
	W =   -90.000 deg,	P =    89.770 deg,	R =   180.000 deg
};
P[19]{
   GP1:
	UF : 2, UT : 3,	
	J1=    76.665 deg,	J2=     1.620 deg,	J3=     3.605 deg,
	J4=   180.031 deg,	J5=    93.734 deg,	J6=   103.337 deg
};
P[20]{
   GP1:
	UF : 2, UT : 3,	
	J1=    76.629 deg,	J2=     0.810 deg,	J3=     3.578 deg,
	J4=   179.613 deg,	J5=    91.949 deg,	J6=   103.352 deg
};
P[21]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   211.378  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    86.518 deg,	R =     0.000 deg
};
P[22]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   213.461  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    82.806 deg,	R =     0.000 deg
};
P[23]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   215.961  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    78.311 deg,	R =     0.000 deg
};
P[24]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   218.461  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    73.746 deg,	R =     0.000 deg
};
P[25]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   218.878  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    72.983 deg,	R =     0.000 deg
};
P[26]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   219.295  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    72.217 deg,	R =     0.000 deg
};
P[27]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   219.711  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    71.448 deg,	R =     0.000 deg
};
P[28]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   220.128  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    70.676 deg,	R =     0.000 deg
};
P[29]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   221.378  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    68.329 deg,	R =     0.000 deg
};
P[30]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   223.045  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    65.133 deg,	R =     0.000 deg
};
P[31]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   224.711  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    61.854 deg,	R =     0.000 deg
};
P[32]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   226.378  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    58.472 deg,	R =     0.000 deg
};
P[33]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   227.628  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    55.865 deg,	R =     0.000 deg
};
P[34]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   228.461  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    54.092 deg,	R =     0.000 deg
};
P[35]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   229.295  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    52.279 deg,	R =     0.000 deg
};
P[36]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   480.577  mm,	Y =   229.711  mm,	Z =   270.866  mm,
	W =    90.000 deg,	P =    51.362 deg,	R =     0.000 deg
};
/END
