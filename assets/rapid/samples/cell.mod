MODULE SampleCell
  !===========================================================================
  ! What the samples share: tool, poses, speeds, the way to and from a pick.
  ! Part of depal. Licence: MIT OR Apache-2.0.
  ! Teach your own values here; the samples themselves need no change.
  !
  ! Signals: goVacuum    group output, one bit a gripper section
  !          diVacuumOk  input, 1 while the switched-on sections hold vacuum
  !===========================================================================

  ! Gripper: lip plane 300 mm in front of the flange, 50 kg.
  PERS tooldata tGripper:=[TRUE,[[0,0,300],[1,0,0,0]],[50,[0,0,150],[1,0,0,0],0,0,0]];
  ! Out of the camera's view.
  CONST jointtarget jHome:=[[90,-20,20,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! Where cartons are put down.
  CONST robtarget pPlace:=[[500,1500,900],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  CONST string sVisionAddress:="127.0.0.1";
  CONST num nVisionPort:=50000;
  ! Longer than the ten seconds that the vision system allows itself.
  CONST num nVisionTimeout:=30;
  CONST num nJob:=1;

  ! Straight down onto a carton and up again, mm.
  CONST num nApproach:=200;
  ! Height of what is picked, mm: with it two cartons are never mistaken for one.
  CONST num nHeight:=250;

  VAR num nStatus:=0;

  ! Says why, and stops. The vacuum stays as it is: a carton may hang on the gripper.
  PROC Refused(string sReason)
    TPWrite "Stopped: "+sReason\Num:=nStatus;
    MM_Close_Socket;
    Stop;
    EXIT;
  ENDPROC

  ! Begins a sample: the arm at home, the connection open, the vision system ready.
  PROC BeginSample()
    AccSet 100,100;
    ! Poses from the vision system carry no arm configuration.
    ConfJ\Off;
    ConfL\Off;
    SetGO goVacuum,0;
    MM_Init_Socket sVisionAddress,nVisionPort,nVisionTimeout;
    MM_Open_Socket;
    MM_Get_Status nStatus;
    IF nStatus<>1101 Refused "vision not ready, status ";
    MoveAbsJ jHome\NoEOffs,v1000,fine,tGripper\WObj:=wobj0;
  ENDPROC

  PROC EndSample(string sText)
    MoveAbsJ jHome\NoEOffs,v1000,fine,tGripper\WObj:=wobj0;
    MM_Close_Socket;
    TPWrite "Finished: "+sText;
  ENDPROC

  ! Down from above, vacuum on, up again. TRUE if the vacuum holds.
  FUNC bool Pick(robtarget pTarget,num nSections)
    VAR bool bTimeout;

    MoveJ RelTool(pTarget,0,0,-nApproach),v1000,z50,tGripper\WObj:=wobj0;
    MoveL pTarget,v300,fine,tGripper\WObj:=wobj0;
    SetGO goVacuum,nSections;
    WaitDI diVacuumOk,1\MaxTime:=1.5\TimeFlag:=bTimeout;
    MoveL RelTool(pTarget,0,0,-nApproach),v500,z50,tGripper\WObj:=wobj0;
    RETURN NOT bTimeout;
  ENDFUNC

  ! Puts down what hangs on the gripper.
  PROC Place()
    MoveJ RelTool(pPlace,0,0,-nApproach),v1000,z50,tGripper\WObj:=wobj0;
    MoveL pPlace,v300,fine,tGripper\WObj:=wobj0;
    SetGO goVacuum,0;
    WaitDI diVacuumOk,0\MaxTime:=2;
    MoveL RelTool(pPlace,0,0,-nApproach),v1000,z50,tGripper\WObj:=wobj0;
  ENDPROC
ENDMODULE
