MODULE MM_Com_Test
  !===========================================================================
  ! Tests the connection to the vision system and says what is wrong with it.
  ! Part of depal. Licence: MIT OR Apache-2.0. Contains no vendor code.
  ! Stands alone: it needs no other module.
  !
  ! It connects, asks for the state (command 901, as a HEX frame with little-endian
  ! cells) and looks at the answer: whether one comes, whether it is a frame of the
  ! right length and byte order, and what state it tells. MM_Com_Result is 0 if all
  ! is well, else the number of the step that failed:
  !   1 no connection    2 no answer within the time    3 closed by the other side
  !   4 not a HEX frame in this byte order              5 the state is no success
  !===========================================================================

  CONST string MM_Com_Address:="127.0.0.1";
  CONST num MM_Com_Port:=50000;
  ! Longest wait for the connection and for the answer, seconds.
  CONST num MM_Com_Timeout:=10;

  VAR num MM_Com_Result:=0;
  ! The state that was told: 1101 ready, 9100 from 2.2 on.
  VAR num MM_Com_State:=0;

  LOCAL VAR socketdev sTest;

  PROC MM_Com_Test()
    VAR rawbytes request;
    VAR rawbytes answer;
    VAR clock watch;
    VAR num nStep:=1;
    VAR num command;

    MM_Com_Result:=0;
    MM_Com_State:=0;
    SocketCreate sTest;
    SocketConnect sTest,MM_Com_Address,MM_Com_Port\Time:=MM_Com_Timeout;
    TPWrite "MM test: connected to "+MM_Com_Address+" port "\Num:=MM_Com_Port;
    nStep:=2;
    PackRawBytes 901,request,1\IntX:=DINT;
    FOR i FROM 2 TO 16 DO
      PackRawBytes 0,request,4*i-3\IntX:=DINT;
    ENDFOR
    ClkReset watch;
    ClkStart watch;
    SocketSend sTest\RawData:=request;
    GatherAnswer answer;
    ClkStop watch;
    TPWrite "MM test: answered after ms "\Num:=Round(1000*ClkRead(watch)\Dec:=0);
    UnpackRawBytes answer,1,command\IntX:=DINT;
    UnpackRawBytes answer,5,MM_Com_State\IntX:=DINT;
    IF command<>901 OR MM_Com_State<1 OR MM_Com_State>9999 THEN
      Tell 4,"no little-endian HEX frame came: wrong format?";
    ELSEIF MM_Com_State<>1101 AND MM_Com_State<>9100 THEN
      Tell 5,"not ready, see MM_Com_State";
    ELSE
      TPWrite "MM test: passed, status "\Num:=MM_Com_State;
    ENDIF
    SocketClose sTest;
  ERROR
    IF nStep=1 THEN
      Tell 1,"no connection: address, port, cable, firewall?";
    ELSEIF ERRNO=ERR_SOCK_TIMEOUT THEN
      Tell 2,"no complete answer came: wrong format?";
    ELSEIF ERRNO=ERR_SOCK_CLOSED THEN
      Tell 3,"the other side closed the connection";
    ELSE
      SocketClose sTest;
      RAISE;
    ENDIF
    SocketClose sTest;
    RETURN;
  ENDPROC

  ! 660 bytes, in as many pieces as they come.
  LOCAL PROC GatherAnswer(INOUT rawbytes answer)
    VAR rawbytes piece;
    VAR num got:=0;
    VAR num arrived:=0;

    ClearRawBytes answer;
    WHILE got<660 DO
      SocketReceive sTest\RawData:=piece\ReadNoOfBytes:=660-got\NoRecBytes:=arrived\Time:=MM_Com_Timeout;
      CopyRawBytes piece,1,answer,got+1\NoOfBytes:=arrived;
      got:=got+arrived;
    ENDWHILE
  ERROR
    RAISE;
  ENDPROC

  LOCAL PROC Tell(num result,string text)
    MM_Com_Result:=result;
    TPWrite "MM test failed: "+text;
  ENDPROC
ENDMODULE
