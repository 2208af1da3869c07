//! A whole small program: it takes boxes from a stack and puts them on a belt.

use depal_time::SimTime;
use depal_vm::execution::Step;

use crate::fake_system::*;

pub const SOURCE: &str = r#"&ACCESS RVP
&REL 12
&PARAM TEMPLATE = C:\KRC\Roboter\Template\vorgabe
DEF main( )
;FOLD INI
  ;FOLD BASISTECH INI
    GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )
    INTERRUPT ON 3
    BAS (#INITMOV,0 )
  ;ENDFOLD (BASISTECH INI)
;ENDFOLD (INI)
  INT layer

  $TOOL = gripper
  BAS(#VEL_PTP, 60)
  $VEL.CP = 0.8
  PTP XHOME
  FOR layer = 2 TO 1 STEP -1
    pick(layer, picked)
    IF picked THEN
      place(layer)
    ELSE
      MsgNotify("layer %1 is lost", "main", layer)
      EXIT
    ENDIF
  ENDFOR
  PTP XHOME
END

DEF pick(n:IN, ok:OUT)
  DECL INT n
  DECL BOOL ok
  DECL FRAME above
  above = stack
  above.Z = stack.Z + n * box_height
  $APO.CDIS = 40
  SLIN above : {FRAME: X 0.0, Y 0.0, Z -200.0, A 0.0, B 0.0, C 0.0} C_DIS
  $VEL.CP = 0.2
  TRIGGER WHEN DISTANCE=1 DELAY=-40 DO vacuum=TRUE
  LIN above
  ok = sealed(0.5)
  LIN_REL {Z 200.0} C_DIS
  $VEL.CP = 0.8
END

DEFFCT BOOL sealed(most:IN)
  DECL REAL most
  ; The timer begins when the arm is there, not when the program is.
  WAIT SEC 0
  $TIMER[1] = 0
  $TIMER_STOP[1] = FALSE
  WHILE NOT vacuum_ok
    IF $TIMER[1] > most * 1000 THEN
      RETURN FALSE
    ENDIF
    WAIT SEC 0.012
  ENDWHILE
  $TIMER_STOP[1] = TRUE
  RETURN TRUE
ENDFCT

DEF place(n:IN)
  DECL INT n
  PTP {X 800.0, Y 900.0, Z 700.0, A 0.0, B 0.0, C 180.0} C_PTP
  LIN {Z 500.0}
  vacuum = FALSE
  WAIT FOR NOT vacuum_ok
  LIN_REL {Z 200.0}
END
"#;

pub const DATA: &str = r"&ACCESS RVP
DEFDAT main
DECL FRAME gripper={X 0.0,Y 0.0,Z 150.0,A 0.0,B 0.0,C 0.0}
DECL FRAME stack={X 1200.0,Y -300.0,Z 100.0,A 0.0,B 0.0,C 180.0}
DECL REAL box_height=200.0
DECL BOOL picked=FALSE
SIGNAL vacuum $OUT[1]
SIGNAL vacuum_ok $IN[1]
ENDDAT
";

fn run_cell(changes: &[(u64, f64)]) -> (Vec<String>, Step) {
    let mut system = FakeSystem::default();
    for (when, value) in changes {
        let at = SimTime::from_nanos(when * 1_000_000);
        system.changes.push((at, "$IN[1]".into(), *value));
    }
    let mut machine = machine(&[("main.src", SOURCE), ("main.dat", DATA)]);
    let end = run(&mut machine, &mut system);
    (system.trace, end)
}

#[test]
fn the_program_does_what_it_says_in_its_order() {
    // The cups seal and let go a little after each command.
    let changes = [(330, 1.0), (760, 0.0), (1230, 1.0), (1660, 0.0)];
    let (trace, end) = run_cell(&changes);
    assert_eq!(end, Step::Finished, "{trace:#?}");
    insta::assert_snapshot!(trace.join("\n"));
}

#[test]
fn without_a_seal_it_gives_up_after_the_time() {
    let (trace, end) = run_cell(&[]);
    assert_eq!(end, Step::Finished);
    assert_eq!(
        trace.iter().filter(|l| l.contains("is lost")).count(),
        1,
        "{trace:#?}"
    );
    assert!(
        !trace.iter().any(|l| l.contains("tcp 800 900")),
        "{trace:#?}"
    );
}
