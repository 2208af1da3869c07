use depal_controller::ControllerEvent;

use crate::harness::*;

const DATA: &str = "CONST listitem items{3} := [[\"\",\"left\"],[\"\",\"middle\"],[\"\",\"right\"]];\nVAR btnres pressed;\nVAR num n;\nVAR dnum d;\nVAR errnum why;\nVAR string own{2} := [\"Go\",\"No\"];";

fn answered(statements: &str, answers: &[&str], inputs: &[(f64, &str, f64)]) -> Told {
    run_in(statements, DATA, inputs, |spec| {
        spec.answers = answers.iter().map(|a| (*a).to_owned()).collect();
    })
}

#[test]
fn questions_take_their_answers_in_order() {
    let told = answered(
        "pressed := UIMessageBox(\\Header:=\"H\"\\Message:=\"sure?\"\\Buttons:=btnYesNo);\nIF pressed=resNo TPWrite \"no\";\nTPWrite NumToStr(UIMessageBox(\\MsgArray:=[\"a\",\"b\"]\\BtnArray:=own),0);\nTPWrite NumToStr(UIListView(\\Result:=pressed\\Header:=\"which\",items),0);\nTPWrite NumToStr(UIListView(items),0);\nTPWrite UIAlphaEntry(\\Message:=\"name\");\nTPWrite DnumToStr(UIDnumEntry(\\Message:=\"d\"\\MinValue:=1\\MaxValue:=9),1);\nTPWrite NumToStr(UINumTune(\\Message:=\"t\",5,1\\MinValue:=0\\MaxValue:=9),0);\nTPReadDnum d,\"d?\";\nTPWrite DnumToStr(d,0);\nTPReadFK n,\"key\",\"a\",\"b\",stEmpty,stEmpty,stEmpty;\nTPWrite NumToStr(n,0);",
        &["No", "go", "right", "2", "Depal 7", "3.5", "6", "12", "1"],
        &[],
    )
    .finished();
    assert_eq!(
        told.lines,
        ["no", "1", "3", "2", "Depal 7", "3.5", "6", "12", "1"]
    );
    let asked: Vec<_> = told
        .events
        .iter()
        .filter_map(|event| match event {
            ControllerEvent::Answered {
                instruction, text, ..
            } => Some((*instruction, text.as_str())),
            _ => None,
        })
        .collect();
    assert_eq!(asked[0], ("UIMessageBox", "sure?"));
    assert_eq!(asked[1], ("UIMessageBox", "a b"));
    assert_eq!(asked[2], ("UIListView", "which: left, middle, right"));
}

#[test]
fn nobody_answers() {
    let told = answered("n := UIListView(items);", &[], &[]);
    assert!(told.waits_for_ever);
    let told = answered("n := UIListView(items\\MaxTime:=2);", &[], &[]);
    assert_eq!(told.failure(), ("ERR_TP_MAXTIME".to_owned(), 2));
    let told = answered(
        "n := UIListView(items\\DIBreak:=di1);",
        &[],
        &[(1.0, "di1", 1.0)],
    );
    assert_eq!(told.failure(), ("ERR_TP_DIBREAK".to_owned(), 2));
    let told = answered(
        "pressed := UIMessageBox(\\Message:=\"?\"\\MaxTime:=2\\BreakFlag:=why);\nIF why=ERR_TP_MAXTIME TPWrite \"late\";",
        &[],
        &[],
    )
    .finished();
    assert_eq!(told.lines, ["late"]);
}

#[test]
fn answers_that_do_not_fit_are_told() {
    for statements in [
        "n := UIListView(items);",
        "pressed := UIMessageBox(\\Message:=\"?\");",
        "d := UIDnumEntry(\\Message:=\"?\");",
    ] {
        let told = answered(statements, &["banana"], &[]);
        assert_eq!(
            told.failure(),
            ("ERR_ARGVALERR".to_owned(), 2),
            "{statements}"
        );
    }
    assert_eq!(
        answered("n := UIListView(items);", &["4"], &[]).failure().1,
        2
    );
}
