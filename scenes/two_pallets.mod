MODULE MainModule
  !===========================================================================
  ! Moves the cartons of one pallet to another, in layers: the vision system finds
  ! and plans, the robot asks and says which place of the pattern is the next one.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (profile 1.8).
  !
  ! One round: start the Viz project from the capture pose, fetch the waypoints
  ! and the gripper's DO list, go to the Vision Move waypoint, switch the vacuum
  ! on, check it, carry on to the last waypoint (the place), release.
  ! A loaded move at p percent is slowed as a whole: velocity p, acceleration p*p.
  ! The next round is started at the place, while the vacuum bleeds off: there
  ! the arm is out of the camera's view, and planning takes no time of its own.
  !
  ! Signals: goVacuum  group output, 16 bit, one bit a gripper section
  !          diVacuumOk  input, 1 while the switched-on sections hold vacuum
  !===========================================================================

  ! Gripper: lip plane 300 mm in front of the flange, 50 kg.
  PERS tooldata tGripper:=[TRUE,[[0,0,300],[1,0,0,0]],[50,[0,0,150],[1,0,0,0],0,0,0]];

  ! Capture pose: arm over the second pallet, out of the camera's view.
  CONST jointtarget jHome:=[[-90,-20,20,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  CONST string sVisionAddress:="127.0.0.1";
  CONST num nVisionPort:=50000;
  ! Longer than the ten seconds that the vision system allows itself.
  CONST num nVisionTimeout:=60;
  CONST num nJob:=1;
  ! Step of the path project that places by the pattern.
  CONST num nPlaceStep:=7;
  CONST num nPlaces:=16;

  ! 100 percent of the path's velocities.
  CONST speeddata vFull:=[5000,500,5000,1000];
  CONST num nAccEmpty:=100;
  CONST num nAccLoaded:=70;
  ! Zones of the waypoints next to a pick or place, and of the others.
  CONST zonedata zNear:=z10;
  CONST zonedata zFree:=z50;
  CONST num nMaxWay:=30;
  CONST num nMaxRetries:=3;
  ! Straight up after the release, mm.
  CONST num nRetreat:=150;

  VAR jointtarget jWay{30};
  VAR num nMoveType{30};
  VAR num nSpeed{30};
  VAR num nWay:=0;
  VAR num nVis:=0;
  VAR num nStatus:=0;
  VAR num nMoved:=0;
  VAR num nRetries:=0;
  ! Next place of the pattern, from 1.
  VAR num nNext:=1;

  PROC main()
    VAR bool bMore:=TRUE;

    AccSet nAccEmpty,nAccEmpty;
    ConfL\Off;
    SetGO goVacuum,0;

    MM_Init_Socket sVisionAddress,nVisionPort,nVisionTimeout;
    MM_Open_Socket;
    MM_Get_Status nStatus;
    IF nStatus<>1101 Refused "vision not ready, status ";
    MM_Set_BoxSize nJob,400,300,250;

    MoveAbsJ jHome\NoEOffs,Speed(50),fine,tGripper\WObj:=wobj0;
    StartRound;
    WHILE bMore AND nNext<=nPlaces DO
      MM_get_plandata 0,3,nWay,nVis,nStatus;
      TEST nStatus
      CASE 2100:
        IF nVis<2 OR nVis>=nWay OR nWay>nMaxWay Refused "unusable path, Vision Move at ";
        MM_Get_DoList 0;
        StorePath;
        IF PickOne() THEN
          IF PlaceOne() THEN
            nRetries:=0;
            nMoved:=nMoved+1;
          ELSE
            CountFailure "Carton lost on the way, attempt ";
          ENDIF
        ELSE
          CountFailure "No vacuum, attempt ";
          GiveUpPick;
          StartRound;
        ENDIF
      CASE 1002,1003,2037,2038:
        bMore:=FALSE;
      DEFAULT:
        Refused "no path, status ";
      ENDTEST
    ENDWHILE

    TPWrite "First pallet empty, cartons moved: "\Num:=nMoved;
    MoveAbsJ jHome\NoEOffs,Speed(50),fine,tGripper\WObj:=wobj0;
    MM_Close_Socket;
  ERROR
    ! The vacuum stays as it is: a carton may hang on the gripper.
    TPWrite "Stopped by error "\Num:=ERRNO;
    TPWrite "Last vision status "\Num:=MM_Last_Status;
    Stop;
  ENDPROC

  ! Starts the path project for the next place, if there is one left.
  PROC StartRound()
    IF nNext>nPlaces RETURN;
    MM_Start_Viz 2,jHome;
    MM_Set_Index nPlaceStep,nNext;
  ENDPROC

  ! Copies the waypoints out of the interface module.
  PROC StorePath()
    VAR num nTool;

    FOR i FROM 1 TO nWay DO
      MM_Get_PlanJps i,3,jWay{i},nMoveType{i},nTool,nSpeed{i};
    ENDFOR
  ENDPROC

  ! Goes to the Vision Move waypoint and grips. TRUE if the vacuum holds.
  FUNC bool PickOne()
    VAR bool bTimeout;

    FOR i FROM 1 TO nVis DO
      Go i;
    ENDFOR
    MM_Set_DoList 1,goVacuum;
    WaitDI diVacuumOk,1\MaxTime:=1.5\TimeFlag:=bTimeout;
    RETURN NOT bTimeout;
  ENDFUNC

  ! One more failed pick in a row; too many are a case for a person.
  PROC CountFailure(string sText)
    nRetries:=nRetries+1;
    TPWrite sText\Num:=nRetries;
    IF nRetries>nMaxRetries Refused "too many failed picks, status ";
  ENDPROC

  ! Carries the carton to the last waypoint, releases it, and lets the vision
  ! system work on the next round meanwhile. FALSE if the carton was lost.
  FUNC bool PlaceOne()
    VAR robtarget pPlace;
    VAR bool bHeld;

    FOR i FROM nVis+1 TO nWay DO
      AccLoaded nSpeed{i};
      Go i;
    ENDFOR
    bHeld:=diVacuumOk=1;
    IF bHeld nNext:=nNext+1;
    AccSet nAccEmpty,nAccEmpty;
    SetGO goVacuum,0;
    StartRound;
    WaitDI diVacuumOk,0;
    pPlace:=CalcRobT(jWay{nWay},tGripper\WObj:=wobj0);
    MoveL Offs(pPlace,0,0,nRetreat),Speed(50),zNear,tGripper\WObj:=wobj0;
    MoveAbsJ jHome\NoEOffs,Speed(100),zFree,tGripper\WObj:=wobj0;
    RETURN bHeld;
  ENDFUNC

  ! Acceleration of a loaded move at this velocity, percent; a cabinet takes 20 at least.
  PROC AccLoaded(num nPercent)
    VAR num nAcc;

    nAcc:=nPercent*nPercent/100;
    IF nAcc>nAccLoaded nAcc:=nAccLoaded;
    IF nAcc<20 nAcc:=20;
    AccSet nAcc,nAcc;
  ENDPROC

  ! Releases and goes back by the way it came.
  PROC GiveUpPick()
    VAR num nBack;

    SetGO goVacuum,0;
    WaitTime 0.3;
    nBack:=nVis-1;
    WHILE nBack>=1 DO
      Go nBack;
      nBack:=nBack-1;
    ENDWHILE
    MoveAbsJ jHome\NoEOffs,Speed(100),fine,tGripper\WObj:=wobj0;
  ENDPROC

  ! One waypoint: stop points at the pick and at the place, corners elsewhere.
  PROC Go(num nIndex)
    IF nIndex=nVis OR nIndex=nWay THEN
      MoveTo nIndex,fine;
    ELSEIF Abs(nIndex-nVis)=1 OR nIndex=nWay-1 THEN
      MoveTo nIndex,zNear;
    ELSE
      MoveTo nIndex,zFree;
    ENDIF
  ENDPROC

  PROC MoveTo(num nIndex,zonedata zEnd)
    IF nMoveType{nIndex}=2 THEN
      MoveL CalcRobT(jWay{nIndex},tGripper\WObj:=wobj0),Speed(nSpeed{nIndex}),zEnd,tGripper\WObj:=wobj0;
    ELSE
      MoveAbsJ jWay{nIndex}\NoEOffs,Speed(nSpeed{nIndex}),zEnd,tGripper\WObj:=wobj0;
    ENDIF
  ENDPROC

  ! Speed data of a percentage.
  FUNC speeddata Speed(num nPercent)
    VAR speeddata vScaled;

    IF nPercent<1 nPercent:=1;
    vScaled:=vFull;
    vScaled.v_tcp:=vFull.v_tcp*nPercent/100;
    vScaled.v_ori:=vFull.v_ori*nPercent/100;
    RETURN vScaled;
  ENDFUNC

  ! Says why, and stops. The vacuum stays as it is.
  PROC Refused(string sReason)
    TPWrite "Stopped: "+sReason\Num:=nStatus;
    MM_Close_Socket;
    Stop;
    EXIT;
  ENDPROC
ENDMODULE
