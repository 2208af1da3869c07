MODULE MainModule
  ! As scenes/eye_in_hand.mod, but the arm goes on while the picture is taken: 100 mm
  ! aside, between what it has told and the exposure.
  CONST robtarget pLook:=[[1380,0,2050],[0,0.70710678,0.70710678,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num nWay:=0;
  VAR num nVis:=0;
  VAR num nStatus:=0;

  PROC main()
    ConfJ\Off;
    ConfL\Off;
    MM_Init_Socket "127.0.0.1",50000,60;
    MM_Open_Socket;
    MoveJ pLook,v2000,fine,tool0\WObj:=wobj0;
    MM_Start_Viz 1,CJointT();
    MoveL Offs(pLook,0,100,0),v500,fine,tool0\WObj:=wobj0;
    MM_get_plandata 0,3,nWay,nVis,nStatus;
    TPWrite "status "\Num:=nStatus;
    MM_Close_Socket;
  ENDPROC
ENDMODULE
