MODULE MM_Auto_Calib
  !===========================================================================
  ! Hand-eye calibration, driven by the vision system (command 701).
  ! Part of depal. Licence: MIT OR Apache-2.0. Contains no vendor code.
  ! Needs MM_Module in any of its versions (1.7, 1.8 or 2.x).
  !
  ! How to: fasten the calibration board, teach pStart with the board in view,
  ! start the calibration in the vision system so that it waits for the robot,
  ! then run MM_Auto_Calib. The robot goes to each pose that it is given, waits,
  ! and tells whether it got there; it ends where it began.
  !===========================================================================

  ! Address and port of the vision system, and the longest wait for it, seconds.
  ! A capture and its computation take longer than other answers.
  CONST string MM_Calib_Address:="127.0.0.1";
  CONST num MM_Calib_Port:=50000;
  CONST num MM_Calib_Timeout:=120;
  ! 1 linear, 2 joint motion.
  CONST num MM_Calib_Move:=2;
  ! 1 the flange poses are driven to, 2 the joint positions.
  CONST num MM_Calib_Kind:=2;
  ! Rest before each capture, seconds: until nothing shakes any more.
  CONST num MM_Calib_Wait:=2;
  ! Where the calibration begins and ends.
  PERS jointtarget jCalibStart:=[[0,-20,10,0,60,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC MM_Auto_Calib()
    ! The poses carry no arm configuration.
    ConfJ\Off;
    ConfL\Off;
    AccSet 50,50;
    MoveAbsJ jCalibStart\NoEOffs,v200,fine,tool0\WObj:=wobj0;
    MM_Init_Socket MM_Calib_Address,MM_Calib_Port,MM_Calib_Timeout;
    MM_Calib MM_Calib_Move,MM_Calib_Kind,MM_Calib_Wait;
    AccSet 100,100;
    TPWrite "MM: calibration finished";
  ERROR
    TPWrite "MM: calibration failed, status "\Num:=MM_Last_Status;
    AccSet 100,100;
    RAISE;
  ENDPROC
ENDMODULE
