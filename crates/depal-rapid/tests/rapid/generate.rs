//! Programs from bytes: every text made here is a right program, whatever the bytes. The fuzz targets use it, too.

/// Takes decisions from bytes; zeros when they are used up, so that everything comes to an end.
struct Choices<'a> {
    bytes: &'a [u8],
    text: String,
    depth: usize,
    /// Statements still to be written.
    left: usize,
    labels: usize,
    in_handler: bool,
    in_function: bool,
}

/// A module with data of all kinds and a `main` that the bytes choose.
pub fn program(bytes: &[u8]) -> String {
    let mut choices = Choices {
        bytes,
        text: String::new(),
        depth: 0,
        left: 60,
        labels: 0,
        in_handler: false,
        in_function: false,
    };
    choices.text.push_str(
        "MODULE generated
  RECORD part num n; string s; pos p; ENDRECORD
  VAR num a; VAR num b := 2; PERS num c := 3; VAR num list{5} := [1,2,3,4,5]; VAR num grid{2,3};
  VAR string s := \"text\"; VAR string t; VAR bool f; VAR bool g := TRUE; VAR dnum d := 1.5;
  VAR part one; VAR part many{2}; VAR pos p := [1,2,3]; VAR orient o := [1,0,0,0]; VAR robtarget target;
  VAR rawbytes raw; VAR clock watch; VAR intnum tick; VAR socketdev socket;
  CONST num five := 5; CONST string words{2} := [\"eins\",\"zwei\"];
",
    );
    choices
        .text
        .push_str("  FUNC num value(num x \\num y)\n    VAR num z;\n");
    choices.in_function = true;
    choices.block(2);
    choices.text.push_str(
        "    IF x > 100 RETURN x;\n    IF Present(y) RETURN y;\n    RETURN x + 1;\n  ERROR\n    RETURN 0;\n  ENDFUNC\n",
    );
    choices
        .text
        .push_str("  PROC change(INOUT num x, VAR string w, num v{*})\n");
    choices.block(2);
    choices.text.push_str("    x := Dim(v, 1);\n");
    choices.in_function = false;
    choices.handler();
    choices.text.push_str("  ENDPROC\n  PROC plain()\n");
    choices.block(2);
    choices.text.push_str("  ENDPROC\n  TRAP ticked\n");
    choices.block(1);
    choices
        .text
        .push_str("  ENDTRAP\n  PROC main()\n    VAR num z;\n    VAR num own{2};\n");
    choices.block(4);
    choices.handler();
    choices.text.push_str("  ENDPROC\nENDMODULE\n");
    choices.text
}

impl Choices<'_> {
    fn choose(&mut self, count: u8) -> u8 {
        match self.bytes.split_first() {
            Some((first, rest)) => {
                self.bytes = rest;
                first % count
            }
            None => 0,
        }
    }

    fn put(&mut self, text: &str) {
        self.text.push_str(text);
    }

    fn line(&mut self, text: &str) {
        self.put("    ");
        self.put(text);
        self.put("\n");
    }

    fn handler(&mut self) {
        if self.choose(3) == 0 {
            return;
        }
        self.put("  ERROR\n");
        self.in_handler = true;
        match self.choose(5) {
            0 => self.line("RETRY;"),
            1 => self.line("IF a > 3 RETRY;"),
            2 => self.line("RAISE;"),
            _ => {}
        }
        self.block(1);
        self.line("TRYNEXT;");
        self.in_handler = false;
    }

    fn block(&mut self, most: u8) {
        let count = self.choose(most + 1);
        for _ in 0..count {
            self.statement();
        }
    }

    fn statement(&mut self) {
        if self.left == 0 || self.depth > 3 {
            self.line("a := a + 1;");
            return;
        }
        self.left -= 1;
        self.depth += 1;
        match self.choose(27) {
            0 => {
                let (to, value) = (self.number_place(), self.number());
                self.line(&format!("{to} := {value};"));
            }
            1 => {
                let value = self.truth();
                self.line(&format!("f := {value};"));
            }
            2 => {
                let value = self.string();
                self.line(&format!("t := {value};"));
            }
            3 => {
                let condition = self.truth();
                self.line(&format!("IF {condition} THEN"));
                self.block(2);
                if self.choose(2) == 1 {
                    self.line("ELSE");
                    self.block(2);
                }
                self.line("ENDIF");
            }
            4 => {
                let (from, to) = (self.number(), self.number());
                let step = ["", " STEP 2", " STEP -1", " STEP a"][usize::from(self.choose(4))];
                self.line(&format!("FOR i FROM {from} TO {to}{step} DO"));
                self.block(3);
                self.line("ENDFOR");
            }
            5 => {
                let condition = self.truth();
                self.line(&format!("WHILE {condition} DO"));
                self.block(3);
                self.line("ENDWHILE");
            }
            6 => {
                let (subject, value) = (self.number(), self.number());
                self.line(&format!("TEST {subject}"));
                self.line(&format!("CASE 1, {value}:"));
                self.block(2);
                self.line("DEFAULT:");
                self.block(1);
                self.line("ENDTEST");
            }
            7 => {
                let value = self.number();
                self.line(&format!("a := value({value});"));
            }
            8 => {
                let (x, y) = (self.number(), self.number());
                self.line(&format!("b := value({x} \\y:={y});"));
            }
            9 => self.line("change c, t, list;"),
            10 => {
                let to = self.number_place();
                self.line(&format!("change {to}, s, grid_row();").replace("grid_row()", "list"));
            }
            11 => {
                let value = self.string();
                self.line(&format!("TPWrite {value};"));
            }
            12 => self.line("many{2} := one; one.p := p; p := many{1}.p + p * 2;"),
            13 => self.line("list := [5,4,3,2,1]; grid := [[1,2,3],[4,5,6]];"),
            14 => {
                let value = self.number();
                self.line(&format!("PackRawBytes {value}, raw, RawBytesLen(raw) + 1 \\Float4;"));
            }
            15 => self.line("UnpackRawBytes raw, 1, a \\IntX:=UINT; ClearRawBytes raw;"),
            16 => {
                let value = self.number();
                self.line(&format!("WaitTime {value};"));
            }
            17 => self.line("ClkReset watch; ClkStart watch; a := ClkRead(watch);"),
            18 => {
                let condition = self.truth();
                self.line(&format!("WaitUntil {condition} \\MaxTime:=0.1;"));
            }
            19 if !self.in_function => {
                let value = self.number();
                self.line(&format!("RAISE {value};"));
            }
            20 => self.line("%\"pl\" + \"ain\"%; "),
            21 => self.line("IDelete tick; CONNECT tick WITH ticked; ITimer 0.01, tick;"),
            22 => {
                self.labels += 1;
                let label = self.labels;
                let condition = self.truth();
                self.line(&format!("IF {condition} GOTO l{label};"));
                self.block(2);
                self.line(&format!("l{label}:"));
            }
            23 => self.line("SetDO do_pump, 1; PulseDO do_pump; IF di_part = 1 a := 0;"),
            24 => self.line("o := OrientZYX(a, b, c); target.rot := o; target := Offs(target, a, b, c); d := d * 2;"),
            25 => self.line("SocketCreate socket; SocketSend socket \\Str:=s; SocketClose socket;"),
            _ => self.line("Incr a;"),
        }
        self.depth -= 1;
    }

    fn number_place(&mut self) -> String {
        match self.choose(8) {
            0 => "a".into(),
            1 => "b".into(),
            2 => "c".into(),
            3 => format!("list{{{}}}", self.index()),
            4 => format!("grid{{{}, {}}}", self.index(), self.index()),
            5 => "one.n".into(),
            6 => format!("many{{{}}}.p.y", self.index()),
            _ => "target.trans.z".into(),
        }
    }

    /// An index that is in range or not; a number alone would be refused before the program runs.
    fn index(&mut self) -> String {
        match self.choose(4) {
            0 => "1".into(),
            1 => "2".into(),
            _ => format!("a + {}", self.number()),
        }
    }

    fn number(&mut self) -> String {
        self.depth += 1;
        let text = if self.depth > 6 {
            "2".to_owned()
        } else {
            match self.choose(16) {
                0 => "1".into(),
                1 => "-3".into(),
                2 => "0.5".into(),
                3 => "1E10".into(),
                4 => "five".into(),
                5 | 6 => self.number_place(),
                7 => format!("({} + {})", self.number(), self.number()),
                8 => format!("({} - {})", self.number(), self.number()),
                9 => format!("{} * {}", self.number(), self.number()),
                10 => format!("({} / {})", self.number(), self.number()),
                11 => format!("({} DIV {})", self.number(), self.number()),
                12 => format!("({} MOD {})", self.number(), self.number()),
                13 => format!("StrLen({})", self.string()),
                14 => format!("Sqrt(Abs({}))", self.number()),
                _ => format!("Round({} \\Dec:=1)", self.number()),
            }
        };
        self.depth -= 1;
        text
    }

    fn truth(&mut self) -> String {
        self.depth += 1;
        let text = if self.depth > 6 {
            "g".to_owned()
        } else {
            match self.choose(10) {
                0 => "f".into(),
                1 => "FALSE".into(),
                2 => format!("({} < {})", self.number(), self.number()),
                3 => format!("({} = {})", self.number(), self.number()),
                4 => format!("({} <> {})", self.string(), self.string()),
                5 => format!("({} AND {})", self.truth(), self.truth()),
                6 => format!("({} OR {})", self.truth(), self.truth()),
                7 => format!("({} XOR {})", self.truth(), self.truth()),
                8 => format!("(NOT {})", self.truth()),
                _ => format!("({} >= {})", self.number(), self.number()),
            }
        };
        self.depth -= 1;
        text
    }

    fn string(&mut self) -> String {
        self.depth += 1;
        let text = if self.depth > 6 {
            "s".to_owned()
        } else {
            match self.choose(9) {
                0 => "s".into(),
                1 => "\"a\\0Db\"".into(),
                2 => "one.s".into(),
                3 => format!("words{{{}}}", self.index()),
                4 => format!("{} + {}", self.string(), self.string()),
                5 => format!("NumToStr({}, 2)", self.number()),
                6 => format!("ValToStr({})", self.number()),
                7 => format!(
                    "StrPart({}, {}, {})",
                    self.string(),
                    self.number(),
                    self.number()
                ),
                _ => "ValToStr(many)".into(),
            }
        };
        self.depth -= 1;
        text
    }
}
