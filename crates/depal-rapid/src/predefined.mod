MODULE predefined(SYSMODULE)
  RECORD pos num x; num y; num z; ENDRECORD
  RECORD orient num q1; num q2; num q3; num q4; ENDRECORD
  RECORD pose pos trans; orient rot; ENDRECORD
  RECORD confdata num cf1; num cf4; num cf6; num cfx; ENDRECORD
  RECORD extjoint num eax_a; num eax_b; num eax_c; num eax_d; num eax_e; num eax_f; ENDRECORD
  RECORD robjoint num rax_1; num rax_2; num rax_3; num rax_4; num rax_5; num rax_6; ENDRECORD
  RECORD robtarget pos trans; orient rot; confdata robconf; extjoint extax; ENDRECORD
  RECORD jointtarget robjoint robax; extjoint extax; ENDRECORD
  RECORD speeddata num v_tcp; num v_ori; num v_leax; num v_reax; ENDRECORD
  RECORD zonedata bool finep; num pzone_tcp; num pzone_ori; num pzone_eax; num zone_ori; num zone_leax; num zone_reax; ENDRECORD
  RECORD loaddata num mass; pos cog; orient aom; num ix; num iy; num iz; ENDRECORD
  RECORD tooldata bool robhold; pose tframe; loaddata tload; ENDRECORD
  RECORD wobjdata bool robhold; bool ufprog; string ufmec; pose uframe; pose oframe; ENDRECORD

  ! What TriggIO, TriggEquip and TriggInt define: kind (0 not yet), distance in mm, lead and delay in s, output, value, interrupt (0 none).
  ! TriggCheckIO: the signal, the value it is compared with, how (0: nothing is compared), whether the arm stops.
  RECORD triggdata num kind; num distance; num lead; num delay; string output; dnum level; num interrupt; num relation; bool stops; ENDRECORD
  RECORD triggios bool used; num distance; bool start; num equiplag; string signalname; num setvalue; num xxx; ENDRECORD
  RECORD triggiosdnum bool used; num distance; bool start; num equiplag; string signalname; dnum setvalue; num xxx; ENDRECORD
  RECORD triggstrgo bool used; num distance; bool start; num equiplag; string signalname; stringdig setvalue; num xxx; ENDRECORD
  ! What GetTrapData takes down of the message that ordered the interrupt.
  RECORD trapdata bool taken; num domain; num identity; num severity; string title; string str1; string str2; string str3; string str4; string str5; ENDRECORD
  ! Where GetNextSym found a datum: its place, from 1.
  RECORD datapos num place; ENDRECORD
  ! A file: its path in the program's folder, what it is open for (0 not open, 1 to read, 2 to write), the position.
  RECORD iodev string path; dnum purpose; dnum position; ENDRECORD
  ! A meeting point of tasks: its name is the name of the variable.
  RECORD syncident string name; ENDRECORD
  RECORD tasks string taskname; ENDRECORD
  RECORD listitem string image; string text; ENDRECORD
  RECORD inposdata num position; num speed; num mintime; num maxtime; ENDRECORD
  RECORD stoppointdata num type; bool progsynch; inposdata inpos; num stoptime; num followtime; string signal; num relation; num checkvalue; ENDRECORD

  CONST loaddata load0 := [0.001,[0,0,0.001],[1,0,0,0],0,0,0];
  PERS tooldata tool0 := [TRUE,[[0,0,0],[1,0,0,0]],[0.001,[0,0,0.001],[1,0,0,0],0,0,0]];
  PERS wobjdata wobj0 := [FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];

  CONST speeddata v5 := [5,500,5000,1000];
  CONST speeddata v10 := [10,500,5000,1000];
  CONST speeddata v20 := [20,500,5000,1000];
  CONST speeddata v30 := [30,500,5000,1000];
  CONST speeddata v40 := [40,500,5000,1000];
  CONST speeddata v50 := [50,500,5000,1000];
  CONST speeddata v60 := [60,500,5000,1000];
  CONST speeddata v80 := [80,500,5000,1000];
  CONST speeddata v100 := [100,500,5000,1000];
  CONST speeddata v150 := [150,500,5000,1000];
  CONST speeddata v200 := [200,500,5000,1000];
  CONST speeddata v300 := [300,500,5000,1000];
  CONST speeddata v400 := [400,500,5000,1000];
  CONST speeddata v500 := [500,500,5000,1000];
  CONST speeddata v600 := [600,500,5000,1000];
  CONST speeddata v800 := [800,500,5000,1000];
  CONST speeddata v1000 := [1000,500,5000,1000];
  CONST speeddata v1500 := [1500,500,5000,1000];
  CONST speeddata v2000 := [2000,500,5000,1000];
  CONST speeddata v2500 := [2500,500,5000,1000];
  CONST speeddata v3000 := [3000,500,5000,1000];
  CONST speeddata v4000 := [4000,500,5000,1000];
  CONST speeddata v5000 := [5000,500,5000,1000];
  CONST speeddata v6000 := [6000,500,5000,1000];
  CONST speeddata v7000 := [7000,500,5000,1000];
  CONST speeddata vmax := [7000,500,5000,1000];

  CONST zonedata fine := [TRUE,0,0,0,0,0,0];
  CONST zonedata z0 := [FALSE,0.3,0.3,0.3,0.03,0.3,0.03];
  CONST zonedata z1 := [FALSE,1,1,1,0.1,1,0.1];
  CONST zonedata z5 := [FALSE,5,8,8,0.8,8,0.8];
  CONST zonedata z10 := [FALSE,10,15,15,1.5,15,1.5];
  CONST zonedata z15 := [FALSE,15,23,23,2.3,23,2.3];
  CONST zonedata z20 := [FALSE,20,30,30,3,30,3];
  CONST zonedata z30 := [FALSE,30,45,45,4.5,45,4.5];
  CONST zonedata z40 := [FALSE,40,60,60,6,60,6];
  CONST zonedata z50 := [FALSE,50,75,75,7.5,75,7.5];
  CONST zonedata z60 := [FALSE,60,90,90,9,90,9];
  CONST zonedata z80 := [FALSE,80,120,120,12,120,12];
  CONST zonedata z100 := [FALSE,100,150,150,15,150,15];
  CONST zonedata z150 := [FALSE,150,225,225,23,225,23];
  CONST zonedata z200 := [FALSE,200,300,300,30,300,30];

  CONST num inpos := 1;
  CONST num stoptime := 2;
  CONST num fllwtime := 3;
  CONST stoppointdata inpos20 := [1,TRUE,[20,20,0,20],0,0,"",0,0];
  CONST stoppointdata inpos50 := [1,TRUE,[50,50,0,2],0,0,"",0,0];
  CONST stoppointdata inpos100 := [1,TRUE,[100,100,0,1],0,0,"",0,0];
  CONST stoppointdata stoptime0_5 := [2,FALSE,[0,0,0,0],0.5,0,"",0,0];
  CONST stoppointdata stoptime1_0 := [2,FALSE,[0,0,0,0],1,0,"",0,0];
  CONST stoppointdata stoptime1_5 := [2,FALSE,[0,0,0,0],1.5,0,"",0,0];

  CONST num pi := 3.14159265358979;
  CONST num WAIT_MAX := 8388608;
  CONST num EOF_NUM := 9.998E36;
  CONST num EOF_BIN := -1;
  CONST string EOF := "EOF";
  CONST string stEmpty := "";
  CONST num high := 1;
  CONST num low := 0;
  CONST num edge := 2;
  CONST opnum LT := 1;
  CONST opnum LTEQ := 2;
  CONST opnum EQ := 3;
  CONST opnum NOTEQ := 4;
  CONST opnum GTEQ := 5;
  CONST opnum GT := 6;
  CONST errdomain COMMON_ERR := 0;
  CONST errdomain OP_STATE := 1;
  CONST errdomain SYSTEM_ERR := 2;
  CONST errdomain HARDWARE_ERR := 3;
  CONST errdomain PROGRAM_ERR := 4;
  CONST errdomain MOTION_ERR := 5;
  CONST errdomain OPERATOR_ERR := 6;
  CONST errdomain IO_COM_ERR := 7;
  CONST errdomain USER_DEF_ERR := 8;
  CONST errdomain OPTION_PROD_ERR := 9;
  CONST errdomain PROCESS_ERR := 11;
  CONST errdomain CFG_ERR := 12;
  CONST errtype TYPE_ALL := 0;
  CONST errtype TYPE_STATE := 1;
  CONST errtype TYPE_WARN := 2;
  CONST errtype TYPE_ERR := 3;
  ! Marks that ErrLog and ErrRaise fill in.
  CONST errstr ERRSTR_EMPTY := "";
  CONST errstr ERRSTR_UNUSED := "";
  CONST errstr ERRSTR_TASK := "\01";
  CONST errstr ERRSTR_CONTEXT := "\02";
  CONST num AIO_ABOVE_HIGH := 1;
  CONST num AIO_BELOW_HIGH := 2;
  CONST num AIO_ABOVE_LOW := 3;
  CONST num AIO_BELOW_LOW := 4;
  CONST num AIO_BETWEEN := 5;
  CONST num AIO_OUTSIDE := 6;
  CONST num AIO_ALWAYS := 7;
  CONST string diskhome := "HOME:";
  CONST string STR_DIGIT := "0123456789";
  CONST string STR_WHITE := " ";
  CONST string STR_UPPER := "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
  CONST string STR_LOWER := "abcdefghijklmnopqrstuvwxyz";

  CONST num iconNone := 0;
  CONST num iconInfo := 1;
  CONST num iconWarning := 2;
  CONST num iconError := 3;
  CONST num btnNone := -1;
  CONST num btnOK := 0;
  CONST num btnAbrtRtryIgn := 1;
  CONST num btnOKCancel := 2;
  CONST num btnRetryCancel := 3;
  CONST num btnYesNo := 4;
  CONST num btnYesNoCancel := 5;
  CONST num resUnkwn := 0;
  CONST num resOK := 1;
  CONST num resAbort := 2;
  CONST num resRetry := 3;
  CONST num resIgnore := 4;
  CONST num resCancel := 5;
  CONST num resYes := 6;
  CONST num resNo := 7;
  CONST num TP_LATEST := 1;
  CONST num TP_PROGRAM := 2;
  CONST num TP_SCREENVIEWER := 3;
  CONST num OP_UNDEF := 0;
  CONST num OP_AUTO := 1;
  CONST num OP_MAN_PROG := 2;
  CONST num OP_MAN_TEST := 3;
  CONST num RUN_UNDEF := 0;
  CONST num RUN_CONT_CYCLE := 1;
  CONST num RUN_INSTR_FWD := 2;
  CONST num RUN_INSTR_BWD := 3;
  CONST num RUN_SIM := 4;
  CONST num RUN_STEP_MOVE := 5;

  CONST num USINT := 1;
  CONST num UINT := 2;
  CONST num UDINT := 4;
  CONST num ULINT := 8;
  CONST num SINT := -1;
  CONST num INT := -2;
  CONST num DINT := -4;
  CONST num LINT := -8;

  CONST num SOCKET_CREATED := 1;
  CONST num SOCKET_CONNECTED := 2;
  CONST num SOCKET_BOUND := 3;
  CONST num SOCKET_LISTENING := 4;
  CONST num SOCKET_CLOSED := 5;

  VAR num reg1;
  VAR num reg2;
  VAR num reg3;
  VAR num reg4;
  VAR num reg5;
  VAR clock clock1;
ENDMODULE
