//! What a person reads about a wrong program.

use depal_rapid::load;
use depal_syntax::SourceFile;

use crate::fake_system::signals;

fn messages(text: &str) -> String {
    let source = [SourceFile::new("cell.mod", text)];
    let loaded = load(&source, &signals(), "main");
    let lines: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| d.plain(&source))
        .collect();
    lines.join("\n")
}

#[test]
fn an_open_block_is_named_by_its_beginning() {
    insta::assert_snapshot!(messages(
        "MODULE m
  PROC main()
    WHILE TRUE DO
      IF di_part = 1 THEN
        TPWrite \"x\";
    ENDWHILE
  ENDPROC
  PROC other()
    FOR i FROM 1 TO 3 DO
      TPWrite \"y\"
    ENDFOR
  ENDPROC
"
    ));
}

#[test]
fn many_mistakes_in_one_module() {
    insta::assert_snapshot!(messages(
        "MODULE m
  VAR num count;
  VAR string name;
  CONST num limit := 3;
  PROC grip(VAR num force \\switch Soft)
    force := 1;
  ENDPROC
  PROC main()
    cuont := 1;
    name := count;
    limit := 4;
    Movel [[0,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v100, fine;
    SetDO do_pmp, 1;
    grip limit;
    grip count \\Sofft;
    do_pump := 1;
    IF di_part THEN ENDIF
    RETRY;
    WZLimSup \\Temp, zone, shape;
    count := StrLn(name);
    WaitTme 1;
    count := [1,2];
    v100.v_speed := 3;
    RETURN 5;
  ENDPROC
ENDMODULE
"
    ));
}

#[test]
fn duplicates_and_headings() {
    insta::assert_snapshot!(messages(
        "MODULE m
  VAR num a;
  VAR bool A;
  VAR nmu b;
  VAR egmident i;
  VAR num list{0};
  FUNC num f()
  ENDFUNC
  PROC p(num x)
    f;
    p 1, 2;
    x = 3;
    p(1;
  ENDPROC
ENDMODULE
"
    ));
}

#[test]
fn interrupts_are_declared_like_all_data() {
    insta::assert_snapshot!(messages(
        "MODULE m
  PROC main()
    CONNECT a WITH b;
    %\"late\"%;
  UNDO
    TPWrite \"u\";
  ENDPROC
  TRAP b
  ENDTRAP
ENDMODULE
"
    ));
}
