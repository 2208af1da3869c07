use crate::harness::*;

const SEARCH: &str = "TPWrite NumToStr(pFound.trans.x-p0.trans.x,1);";

/// The point found is where the TCP was when the signal came; with \Stop the arm stands right behind it.
#[test]
fn a_search_finds_its_point_and_stops() {
    let told = run_with(
        &format!("SearchL\\Stop,di1,pFound,Offs(p0,400,0,0),v100,tTool;\n{SEARCH}"),
        "",
        &[(2.0, "di1", 1.0)],
    )
    .finished();
    let found: f64 = told.lines[0].parse().expect("a number");
    let there = (told.at(2.0) - told.trace[0]).norm() * 1e3;
    assert!((found - there).abs() < 0.5, "{found} {there}");
    let stood = (told.end() - told.trace[0]).norm() * 1e3;
    assert!(
        stood > found && stood < found + 10.0,
        "stands at {stood}, found {found}"
    );
    assert!(stood < 300.0);
}

/// Without a stop the arm goes on to the end.
#[test]
fn a_flying_search_goes_on_to_its_end() {
    let told = run_with(
        &format!("SearchL di1,pFound,Offs(p0,400,0,0),v100,tTool;\n{SEARCH}"),
        "",
        &[(2.0, "di1", 1.0), (2.5, "di1", 0.0), (3.0, "di1", 1.0)],
    )
    .finished();
    let found: f64 = told.lines[0].parse().expect("a number");
    assert!(
        (found - (told.at(2.0) - told.trace[0]).norm() * 1e3).abs() < 0.5,
        "the first"
    );
    assert!(((told.end() - told.trace[0]).norm() - 0.4).abs() < 1e-6);
}

#[test]
fn searches_that_fail() {
    let go = |switch: &str| format!("SearchL{switch},di1,pFound,Offs(p0,200,0,0),v100,tTool;");
    // Nothing found: the arm is at the end.
    let told = run(&go("\\Stop"));
    assert_eq!(told.failure(), ("ERR_WHLSEARCH".to_owned(), 2));
    assert!(((told.end() - told.trace[0]).norm() - 0.2).abs() < 1e-6);
    // High from the beginning: the arm was not moved.
    let told = run_with(&go("\\Stop"), "", &[(0.0, "di1", 1.0)]);
    assert_eq!(told.failure(), ("ERR_SIGSUPSEARCH".to_owned(), 2));
    assert_eq!(told.end(), told.trace[0]);
    // Supervised, and found twice.
    let twice = [(0.5, "di1", 1.0), (0.8, "di1", 0.0), (1.0, "di1", 1.0)];
    let told = run_with(&go("\\Sup"), "", &twice);
    assert_eq!(told.failure(), ("ERR_WHLSEARCH".to_owned(), 2));
    run_with(&go("\\Sup"), "", &twice[..2]).finished();
}

#[test]
fn flanks_and_levels() {
    let go = |flank: &str| {
        format!("SearchL\\SStop,di1{flank},pFound,Offs(p0,200,0,0),v100,tTool;\n{SEARCH}")
    };
    let inputs = [(0.0, "di1", 1.0), (0.6, "di1", 0.0), (1.2, "di1", 1.0)];
    let found = |flank: &str| {
        let told = run_with(&go(flank), "", &inputs).finished();
        let found: f64 = told.lines[0].parse().expect("a number");
        let place = |seconds| (told.at(seconds) - told.trace[0]).norm() * 1e3;
        (found, [place(0.0), place(0.6), place(1.2)])
    };
    let near = |(found, places): (f64, [f64; 3]), which: usize| {
        let wanted = if which == 2 { found } else { places[which] };
        assert!((found - wanted).abs() < 1.0, "{found} {places:?}");
    };
    near(found("\\NegFlank"), 1);
    near(found("\\Flanks"), 1);
    near(found("\\LowLevel"), 1);
    near(found("\\HighLevel"), 0);
    let (rising, places) = found("\\PosFlank");
    assert!(rising > places[1] + 30.0, "{rising} {places:?}");
}

#[test]
fn a_search_along_an_arc() {
    let told = run_with(
        "SearchC\\Stop,di1,pFound,Offs(p0,100,100,0),Offs(p0,200,0,0),v100,tTool;\nTPWrite NumToStr(Distance(pFound.trans,p0.trans),1);",
        "",
        &[(1.5, "di1", 1.0)],
    )
    .finished();
    let found: f64 = told.lines[0].parse().expect("a number");
    assert!((found - (told.at(1.5) - told.trace[0]).norm() * 1e3).abs() < 0.5);
    assert!(found > 100.0 && found < 160.0);
}
