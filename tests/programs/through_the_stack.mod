MODULE ThroughTheStack
  ! Drives the gripper through the middle of the pallet, as a wrong target would.
  PERS tooldata tGripper:=[TRUE,[[0,0,300],[1,0,0,0]],[50,[0,0,150],[1,0,0,0],0,0,0]];
  CONST robtarget pBefore:=[[900,-900,900],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBehind:=[[1700,900,900],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC main()
    ConfJ\Off;
    ConfL\Off;
    MoveJ pBefore,v1000,fine,tGripper\WObj:=wobj0;
    MoveL pBehind,v500,fine,tGripper\WObj:=wobj0;
    TPWrite "through";
  ENDPROC
ENDMODULE
