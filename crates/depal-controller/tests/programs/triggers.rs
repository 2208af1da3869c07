use crate::harness::*;

fn left(told: &Told, seconds: f64) -> f64 {
    (told.end() - told.at(seconds)).norm()
}

#[test]
fn an_output_fires_so_far_before_the_target() {
    let told = run("TriggIO trigg,100\\DOp:=do1,1;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;\nSetDO do2,1;").finished();
    let (edge, reached) = (told.edge("do1"), told.edge("do2"));
    assert!((left(&told, edge) - 0.1).abs() < 1e-3);
    assert!(edge < reached - 0.15, "{edge} {reached}");
    // From the start.
    let told = run(
        "TriggIO trigg,100\\Start\\DOp:=do1,1;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;",
    )
    .finished();
    assert!((left(&told, told.edge("do1")) - 0.3).abs() < 1e-3);
}

#[test]
fn an_output_fires_so_long_before_the_target() {
    let told =
        run("TriggIO trigg,0.2\\Time\\DOp:=do1,1;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;")
            .finished();
    let before = told.reached(3) - told.edge("do1");
    assert!((before - 0.2).abs() < 1e-6, "{before}");
}

#[test]
fn equipment_has_its_lag() {
    let place = |lag: &str| {
        let told = run(&format!("TriggEquip trigg,100,{lag}\\GOp:=go1,5;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;")).finished();
        assert_eq!(told.edges("go1").len(), 1);
        assert_eq!(told.edges("go1")[0].1, 5.0);
        told.edge("go1")
    };
    let (none, early, late) = (place("0"), place("0.1"), place("-0.1"));
    assert!((none - early - 0.1).abs() < 1e-6);
    assert!((late - none - 0.1).abs() < 1e-6);
    let told = run("TriggEquip trigg,100,0\\DOp:=do1,1\\Inhib:=TRUE;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;").finished();
    assert!(told.edges("do1").is_empty(), "inhibited: set to 0");
}

/// Several on one move, by distance: in the order of their places; joint and circular moves have them too.
#[test]
fn several_triggers_on_one_move() {
    let define = "TriggIO trigg,50\\DOp:=do1,1;\nTriggIO other,150\\AOp:=ao1,2.5;\n";
    for go in [
        "TriggL Offs(p0,400,0,0),v500,trigg\\T2:=other,fine,tTool;",
        "TriggJ Offs(p0,400,0,0),v500,trigg\\T2:=other,fine,tTool;",
        "TriggC Offs(p0,200,200,0),Offs(p0,400,0,0),v500,trigg\\T2:=other,fine,tTool;",
    ] {
        let told = run(&format!("{define}{go}")).finished();
        let (first, second) = (told.edge("ao1"), told.edge("do1"));
        assert!(first < second && second < told.reached(4), "{go}");
        assert_eq!(told.edges("ao1")[0].1, 2.5);
        // The chord of 50 mm of an arc is a little shorter.
        assert!((left(&told, second) - 0.05).abs() < 2e-3, "{go}");
    }
}

/// In a corner the middle is the end.
#[test]
fn triggers_of_fly_by_moves() {
    let told = run("TriggIO trigg,0\\DOp:=do1,1;\nTriggIO other,20\\Start\\DOp:=do2,1;\nTriggL Offs(p0,300,0,0),v300,trigg,z100,tTool;\nTriggL Offs(p0,300,300,0),v300,other,fine,tTool;").finished();
    let place = told.at(told.edge("do1")) - told.trace[0];
    assert!(
        (place.x - 0.3 + place.y).abs() < 5e-3,
        "on the bisector: {place}"
    );
    assert!(told.edge("do2") > told.edge("do1"));
    assert!(told.edge("do2") < told.reached(4));
}

#[test]
fn triggers_are_refused_where_they_are_wrong() {
    let told = run("TriggL Offs(p0,300,0,0),v300,trigg,fine,tTool;");
    assert_eq!(told.failure().1, 2);
    let told = run("TriggIO trigg,0.9\\Time\\DOp:=do1,1;");
    assert_eq!(told.failure().1, 2);
    let told =
        run("TriggIO trigg,10\\GOp:=go1,999;\nTriggL Offs(p0,300,0,0),v300,trigg,fine,tTool;");
    assert_eq!(told.failure(), ("ERR_SIG_NOT_VALID".to_owned(), 3));
}
