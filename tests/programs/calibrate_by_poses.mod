MODULE MainModule
  ! Calibrates by flange poses instead of joints, and does nothing else.
  CONST num nMoveType:=2;

  PROC main()
    ! Poses from outside carry no arm configuration: the nearest one is taken.
    ConfJ\Off;
    ConfL\Off;
    MM_Init_Socket "127.0.0.1",50000,60;
    MM_Open_Socket;
    MM_Calib nMoveType,1,0.2;
    TPWrite "back again";
    MM_Close_Socket;
  ENDPROC
ENDMODULE
