MODULE MainModule
  !===========================================================================
  ! Asks the vision system for what lies on the platform, and moves nothing.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (profile 1.8).
  !===========================================================================

  CONST jointtarget jHome:=[[90,-20,20,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST num nCartons:=8;
  VAR num nFound:=0;
  VAR num nStatus:=0;

  PROC main()
    MM_Init_Socket "127.0.0.1",50000,60;
    MM_Open_Socket;
    MM_Get_Status nStatus;
    IF nStatus<>1101 Refused "vision not ready, status ";
    MM_Switch_Model 1,1;
    MM_Set_BoxSize 1,400,300,250;
    MM_Start_Vis 1,0,0,jHome;
    MM_Get_VisData 1,nFound,nStatus;
    IF nStatus<>1100 Refused "no points, status ";
    TPWrite "Cartons found: "\Num:=nFound;
    IF nFound<>nCartons Refused "not every carton was found, status ";
    MM_Close_Socket;
  ENDPROC

  PROC Refused(string sReason)
    TPWrite "Stopped: "+sReason\Num:=nStatus;
    MM_Close_Socket;
    Stop;
    EXIT;
  ENDPROC
ENDMODULE
