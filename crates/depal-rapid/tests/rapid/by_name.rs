//! Module data found by their names: one rule each.

use depal_rapid::load;
use depal_syntax::SourceFile;
use depal_vm::Machine;
use depal_vm::execution::Step;

use crate::fake_system::*;

const DATA: &str = "VAR num a1 := 3;\nVAR num a2 := 4;\nPERS num a3 := 5;\nCONST num a4 := 6;\nLOCAL VAR num b1 := 7;\nVAR string s := \"text\";\nVAR pos p := [1,2,3];\nVAR pos q := [7,8,9];\nVAR num list{2} := [8,9];\nVAR num other{3};\nVAR dnum d;\nVAR num n;\nVAR string name;\nVAR datapos block;";

#[track_caller]
fn check(statements: &str, expected: &[&str]) {
    assert_eq!(output(DATA, statements), expected, "{statements}");
}

#[test]
fn values_are_read_and_written_by_a_computed_name() {
    check(
        "FOR i FROM 1 TO 4 DO GetDataVal \"A\" + NumToStr(i, 0), n; TPWrite ValToStr(n); ENDFOR",
        &["3", "4", "5", "6"],
    );
    check(
        "SetDataVal \"a\" + \"2\", 40; SetDataVal \"p\", q; SetDataVal \"s\", \"new\"; SetDataVal \"list\", other; TPWrite ValToStr(a2) + ValToStr(p) + s;\nERROR\nIF ERRNO = ERR_INVDIM TPWrite \"dimension\";\nTRYNEXT;",
        &["dimension", "40[7,8,9]new"],
    );
    check(
        "SetDataVal \"b1\", 1; GetDataVal \"list\", other;\nERROR\nTPWrite \"b1 \" + ValToStr(b1); IF ERRNO = ERR_INVDIM TPWrite \"dimension\";\nTRYNEXT;",
        &["b1 1", "dimension"],
    );
}

#[test]
fn what_is_not_there_constant_or_of_another_type_has_its_error() {
    for (statement, name) in [
        ("GetDataVal \"a9\", n;", "ERR_SYM_ACCESS"),
        ("SetDataVal \"a4\", 1;", "ERR_SYM_ACCESS"),
        ("SetDataVal \"pi\", 3;", "ERR_SYM_ACCESS"),
        (
            "GetDataVal \"a1\" \\TaskName:=\"T_SIDE\", n;",
            "ERR_SYM_ACCESS",
        ),
        ("GetDataVal \"s\", n;", "ERR_SYMBOL_TYPE"),
        ("GetDataVal \"a1\", d;", "ERR_SYMBOL_TYPE"),
        ("SetDataVal \"s\", 1;", "ERR_SYMBOL_TYPE"),
    ] {
        check(
            &format!("{statement}\nERROR\nIF ERRNO = {name} TPWrite \"right\";\nTRYNEXT;"),
            &["right"],
        );
        let unhandled = output(DATA, statement);
        assert!(unhandled[0].contains(name), "{unhandled:?}");
    }
    check(
        "GetDataVal \"a1\" \\TaskName:=\"T_ROB1\", n; TPWrite ValToStr(n);",
        &["3"],
    );
}

#[test]
fn a_search_hands_out_what_fits_one_by_one() {
    let all = "WHILE GetNextSym(name, block) DO GetDataVal name \\Block:=block, n; TPWrite name + \"=\" + ValToStr(n); ENDWHILE";
    for (search, expected) in [
        (
            "\"num\" \\Object:=\"a.*\"",
            vec!["a1=3", "a2=4", "a3=5", "a4=6"],
        ),
        ("\"num\" \\Object:=\"A[12]\" ", vec!["a1=3", "a2=4"]),
        (
            "\"num\" \\Object:=\"[abn][^3-9]?\" \\VarSym",
            vec!["a1=3", "a2=4", "b1=7", "n=7"],
        ),
        ("\"num\" \\PersSym", vec!["a3=5"]),
        ("\"num\" \\ConstSym \\InMod:=\"m\"", vec!["a4=6"]),
        ("\"num\" \\LocalSym", vec!["b1=7"]),
        ("\"num\" \\Object:=\"a\"", vec![]),
        ("\"num\" \\InMod:=\"elsewhere\"", vec![]),
    ] {
        check(&format!("SetDataSearch {search}; {all}"), &expected);
    }
    check(
        "SetAllDataVal \"num\" \\Object:=\"a.\", 1; TPWrite ValToStr(a1) + ValToStr(a2) + ValToStr(a3) + ValToStr(a4) + ValToStr(b1);",
        &["11167"],
    );
}

#[test]
fn a_module_sees_its_own_local_data_first() {
    let modules = [
        "MODULE one\nLOCAL VAR num x := 1;\nPROC main()\nVAR num n;\nGetDataVal \"x\", n;\nTPWrite ValToStr(n);\ntwo_p;\nthree_p;\nENDPROC\nENDMODULE\n",
        "MODULE two\nLOCAL VAR num x := 2;\nPROC two_p()\nVAR num n;\nGetDataVal \"x\", n;\nTPWrite ValToStr(n);\nENDPROC\nENDMODULE\n",
        "MODULE three\nPROC three_p()\nVAR num n;\nGetDataVal \"x\", n;\nENDPROC\nENDMODULE\n",
    ];
    let sources = modules.map(|text| SourceFile::new("m.mod", text));
    let loaded = load(&sources, &signals(), "main");
    let mut machine = Machine::new(loaded.program.expect("it loads"), "T_ROB1");
    let mut system = FakeSystem::default();
    let end = run(&mut machine, &mut system);
    assert_eq!(system.trace, ["1", "2"]);
    let Step::Failed(error) = end else {
        panic!("{end:?}")
    };
    assert_eq!(error.name, "ERR_SYM_ACCESS");
}
