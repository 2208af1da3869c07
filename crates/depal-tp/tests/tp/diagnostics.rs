//! Messages: all of a file at once, with their places.

use depal_syntax::SourceFile;
use depal_tp::{Options, check, check_syntax, load};

fn shown(texts: &[(&str, &str)]) -> String {
    let sources: Vec<_> = texts.iter().map(|(n, t)| SourceFile::new(*n, *t)).collect();
    let loaded = load(&sources, &Options::default(), "MAIN");
    let shown: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| d.plain(&sources))
        .collect();
    shown.join("\n")
}

#[test]
fn mistakes_of_the_text() {
    let text = "\
/PROG  MAIN
/MN
   1:  R[1]=1
   2:  R[2=2 ;
   3:  CAL SUB ;
   4:  R[3]=1+ ;
   5:  J P[1] 50mm/sec FINE ;
   6:  L P[1] 50mm/sec ;
   7:  L P[1] 50mm/sec FINE Ofset,PR[1] ;
   8:  IF R[1]=1 JMP LBL[1] ;
   9:  WAIT DI[1]=ON TIMEOUT LBL[1] ;
  10:  SR[1]='open ;
  11:  R[1]=R[1]+1 R[2]=2 ;
     :  R[3]=3 ;
  12:  DO[1]=ON+ ;
  13:  R[1]=ANSWER ;
  14:  FOR DO[1]=1 TO 3 ;
  15:  LBL[1]
   :  ;
/POS
P[1]{
   GP1:
\tUF : 0, UT : 1,
\tX = 1.0 mm, Q = 2.0 mm
};
P[2]{
   GP1:
\tUF : 0, UT : 1
};
P[2]{
\tX = 1.0 mm
};
/EDN
";
    insta::assert_snapshot!(shown(&[("MAIN.LS", text)]));
}

#[test]
fn mistakes_of_the_meaning() {
    let text = "\
/PROG  MAIN
/MN
   1:  JMP LBL[7] ;
   2:  LBL[1] ;
   3:  LBL[1] ;
   4:  IF (R[1]) THEN ;
   5:  FOR R[1]=1 TO 3 ;
   6:  ENDIF ;
   7:  ELSE ;
   8:  R[1]=PR[1] ;
   9:  PR[1]=5 ;
  10:  DI[1]=ON ;
  11:  IF DI[1]=ON AND R[1],JMP LBL[1] ;
  12:  CALL SUBB ;
  13:  CALL MM_GET_VIS(1,51) ;
  14:  CALL MM_GET_VISS(1,51,52) ;
  15:  RUN OTHER ;
  16:  L P[1] 50mm/sec FINE Skip,LBL[1] ;
  17:  R[2]=SR[1]+1 ;
  18:  =3,JMP LBL[1] ;
  19:  MONITOR WATCH ;
  20:  L P[1] 50mm/sec FINE TB .1sec,CALL SUB ;
/POS
/END
/PROG  SUB
/MN
/POS
/END
";
    let again = "/PROG sub\n/MN\n/POS\n/END\n";
    insta::assert_snapshot!(shown(&[("MAIN.LS", text), ("SUB.LS", again)]));
}

#[test]
fn files_that_are_no_listings() {
    let all = [
        ("A.LS", ""),
        ("B.LS", "MODULE demo\nENDMODULE\n"),
        ("C.LS", "/PROG OTHER\n/MN\n   1:  END ;\n"),
    ];
    insta::assert_snapshot!(shown(&all));
}

#[test]
fn checking_needs_no_entry() {
    let source = SourceFile::new("A.LS", "/PROG A\n/MN\n   1:  CALL B ;\n/POS\n/END\n");
    let loaded = check(std::slice::from_ref(&source));
    assert!(loaded.program.is_some());
    assert_eq!(loaded.diagnostics.len(), 1);
    assert!(check_syntax(&[source]).is_empty());
}
