//! Errors that no handler takes, as the operator reads them.

use depal_vm::execution::Step;

use crate::fake_system::*;

fn report(data: &str, statements: &str) -> String {
    let text = format!(
        "MODULE cell\n{data}\nPROC main()\nWaitTime 0.5;\nwork;\nENDPROC\nPROC work()\nVAR num z;\n{statements}\nENDPROC\nENDMODULE\n"
    );
    let mut machine = machine(&text);
    let mut system = FakeSystem {
        connect_after: None,
        ..FakeSystem::default()
    };
    match run(&mut machine, &mut system) {
        Step::Failed(error) => error.report(system.now),
        other => format!("{other:?}"),
    }
}

#[test]
fn every_run_time_error_says_where_when_and_what() {
    let cases = [
        ("", "z := 1 / z;"),
        ("VAR num list{3};", "z := 4;\nlist{z} := 1;"),
        ("VAR num grid{2,3};", "z := 0;\nz := grid{1,z};"),
        (
            "VAR string s := \"0123456789012345678901234567890123456789\";",
            "s := s + s + \"x\";",
        ),
        ("PROC endless()\nendless;\nENDPROC", "endless;"),
        ("PROC p(\\num x)\nx := x + 1;\nENDPROC", "p;"),
        (
            "FUNC num f(num n)\nIF n > 1 RETURN n;\nENDFUNC",
            "z := f(1);",
        ),
        ("", "RAISE 17;"),
        ("PROC p()\nRAISE ERR_DIVZERO;\nERROR\nRAISE;\nENDPROC", "p;"),
        ("", "%\"nobody\"%;"),
        ("", "FOR i FROM 1 TO 3 STEP z DO\nENDFOR"),
        ("", "WaitDI di_part, 1 \\MaxTime:=2;"),
        ("", "WaitUntil di_part = 1 \\MaxTime:=2;"),
        ("VAR rawbytes r;", "PackRawBytes 300, r, 1 \\IntX:=USINT;"),
        (
            "VAR socketdev s;",
            "SocketCreate s;\nSocketConnect s, \"192.168.0.10\", 50000;",
        ),
        ("", "SetGO go_zone, 16;"),
        (
            "VAR robtarget far := [[99999,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nVAR jointtarget j;",
            "j := CalcJointT(far, tool0);",
        ),
        ("", "z := Sqrt(-1);"),
        ("", "z := StrLen(StrPart(\"abc\", 5, 1));"),
    ];
    let mut shown = Vec::new();
    for (data, statements) in cases {
        shown.push(format!(
            "> {}\n{}",
            statements.replace('\n', " "),
            report(data, statements)
        ));
    }
    insta::assert_snapshot!(shown.join("\n"));
}
