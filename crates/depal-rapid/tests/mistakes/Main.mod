%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%
MODULE Main
  ! A cell's program with ten mistakes of ten kinds, two modules in one folder.
  CONST robtarget home := [[600,0,900],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PERS tooldata gripper := [TRUE,[[0,0,120],[1,0,0,0]],[8,[0,0,60],[1,0,0,0],0,0,0]];
  CONST num rows := 4;
  VAR num count;

  PROC main()
    MoveL Offs(home,0,0,100), v500, z10, gripper;
    cuont := 0;
    FOR i FROM 1 TO rows DO
      pick i;
      rows := rows - 1;
    ENDFOR
    IF di_part = 1 THEN
      SetDO do_pmup, 1;
    ENDIF
    TPWrite count;
    MoveL home, v500, z10;
    WaitTime 0.5, 1;
    report "done" \Loudly;
  ENDPROC

  PROC pick(num n)
    VAR num pause
    pause := n * 0.1;
    WaitTme pause;
    Strength;
  ENDPROC
ENDMODULE
