//! Listings to routines of the machine.

mod call;
mod expression;
mod motion;
mod routine;
mod statement;

use std::collections::{BTreeMap, BTreeSet};

use depal_syntax::{Diagnostic, Span};
use depal_vm::{Builtin, LanguageRules, Op, Program, Routine, Value};

use crate::Options;
use crate::builtins::table;
use crate::errors;
use crate::state;
use crate::syntax::tree::{Along, Expr, Listing, Name, Statement};

/// Most calls inside each other.
const RECURSION_LIMIT: usize = 200;

/// Lowers all listings. What it makes is good to run only if no error is among the diagnostics.
pub(crate) fn compile(
    listings: &[Listing],
    options: &Options,
    entry: Option<&str>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Program {
    let (globals, global_names) = state::initial(options);
    let mut compiler = Compiler {
        listings,
        programs: BTreeMap::new(),
        builtins: table(),
        skip_conditions: Vec::new(),
        globals,
        global_names,
        diagnostics,
        body: Body::default(),
        program: 0,
        has_groups: !options.groups.is_empty(),
    };
    compiler.headings();
    let routines = (0..listings.len())
        .map(|index| compiler.routine(index))
        .collect();
    let entry = compiler.entry(entry);
    Program {
        routines,
        entry,
        initializer: None,
        globals: compiler.globals,
        global_names: compiler.global_names,
        builtins: compiler.builtins,
        rules: LanguageRules {
            raise: errors::raise,
            error_name: |_| None,
            recursion_limit: RECURSION_LIMIT,
            for_counts_down: false,
            ..LanguageRules::default()
        },
        ..Program::default()
    }
}

/// A jump whose label is not known yet: where its operation stands.
struct OpenJump {
    at: usize,
    label: u32,
    span: Span,
}

/// A block that has been opened.
enum Block {
    /// The jump over the THEN part, and the one over the ELSE part.
    If {
        span: Span,
        skip: usize,
        end: Option<usize>,
    },
    For {
        span: Span,
        begin: u32,
        exit: usize,
        counter: Expr,
        last: u32,
        down: bool,
    },
}

/// The routine being made.
#[derive(Default)]
struct Body {
    code: Vec<Op>,
    locals: Vec<Value>,
    labels: BTreeMap<u32, (u32, Span)>,
    open_jumps: Vec<OpenJump>,
    blocks: Vec<Block>,
    /// The select whose cases may still come: its subject's local, and the jumps to its end.
    select: Option<(u32, Vec<usize>)>,
    /// Outputs behind a CNT move that are switched in its corner.
    in_corner: Vec<Along>,
    /// Lines that have been taken for them.
    taken: BTreeSet<usize>,
    /// Where the statement began whose `next` is still open.
    statement: Option<usize>,
}

struct Compiler<'a> {
    listings: &'a [Listing],
    /// Program names in capitals.
    programs: BTreeMap<String, u32>,
    builtins: Vec<Builtin>,
    /// Conditions of all SKIP CONDITION instructions, by the place of their line.
    skip_conditions: Vec<(Span, &'a Expr)>,
    globals: Vec<Value>,
    global_names: Vec<String>,
    diagnostics: &'a mut Vec<Diagnostic>,
    body: Body,
    /// Index of the listing being lowered.
    program: usize,
    /// Whether digital outputs may be bits of another signal.
    has_groups: bool,
}

impl Compiler<'_> {
    fn error(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    fn headings(&mut self) {
        let mut first: BTreeMap<String, &Name> = BTreeMap::new();
        for (index, listing) in self.listings.iter().enumerate() {
            let key = listing.name.text.to_uppercase();
            if let Some(before) = first.get(&key) {
                let message = format!("there are two programs named {}", listing.name.text);
                let span = listing.name.span;
                let before = before.span;
                self.error(
                    Diagnostic::error("TP0200", span, message).secondary(before, "the first"),
                );
            } else {
                first.insert(key.clone(), &listing.name);
                self.programs.insert(key, index as u32);
            }
            let taught = listing.positions.iter().map(|taught| {
                let number = Value::Dnum(f64::from(taught.number));
                Value::Array(vec![number, taught.position.to_value()])
            });
            self.globals.push(Value::Array(taught.collect()));
            self.global_names
                .push(format!("P of {}", listing.name.text));
            for line in &listing.lines {
                if let Statement::SkipCondition(condition) = &line.statement {
                    self.skip_conditions.push((line.span, condition));
                }
            }
        }
    }

    fn entry(&mut self, entry: Option<&str>) -> u32 {
        let Some(name) = entry else {
            return 0;
        };
        let key = name.to_uppercase();
        if let Some(index) = self.programs.get(&key) {
            return *index;
        }
        let span = self
            .listings
            .first()
            .map(|l| l.name.span)
            .unwrap_or_default();
        let mut message = Diagnostic::error(
            "TP0201",
            span,
            format!("there is no program {name} to start"),
        );
        if let Some(near) = self.near_program(&key) {
            message = message.help(format!("did you mean {near}?"));
        } else if let Some(first) = self.listings.first() {
            let first = &first.name.text;
            message = message.help(format!(
                "the first program here is {first}; a file is started at the program of its own name"
            ));
        }
        self.error(message);
        0
    }

    /// A program or vision call of nearly this name.
    fn near_program(&self, key: &str) -> Option<String> {
        let programs = self.listings.iter().map(|l| l.name.text.clone());
        let calls = crate::mm::CALLS.iter().map(|call| call.name.to_owned());
        depal_syntax::nearest_name(key, programs.chain(calls))
    }

    fn builtin(&self, name: &str) -> u32 {
        let at = self.builtins.iter().position(|b| b.name == name);
        at.expect("the lowering names built-ins of the table") as u32
    }

    fn emit(&mut self, op: Op) -> usize {
        self.body.code.push(op);
        self.body.code.len() - 1
    }

    fn here(&self) -> u32 {
        self.body.code.len() as u32
    }

    fn new_local(&mut self) -> u32 {
        self.body.locals.push(Value::Dnum(0.0));
        self.body.locals.len() as u32 - 1
    }

    /// Makes the jump at a place go here.
    fn land(&mut self, at: usize) {
        let here = self.here();
        match &mut self.body.code[at] {
            Op::Jump(target) | Op::JumpIfFalse(target) => *target = here,
            _ => {}
        }
    }

    fn call_builtin(&mut self, name: &str, arguments: u32, result: bool) {
        let builtin = self.builtin(name);
        self.emit(Op::CallBuiltin {
            builtin,
            arguments,
            result,
        });
    }

    /// What follows touches the world: the arm must have passed the corner of the move before.
    fn settle(&mut self) {
        self.call_builtin("settle", 0, false);
    }

    fn push_number(&mut self, value: f64) {
        self.emit(Op::Push(Value::Dnum(value)));
    }

    fn push_text(&mut self, text: impl Into<String>) {
        self.emit(Op::Push(Value::Str(text.into())));
    }

    fn refuse(&mut self, span: Span, what: &str) {
        self.error(
            Diagnostic::warning("TP0290", span, format!("{what} is not simulated"))
                .help("the program stops with an error when it gets here"),
        );
        self.push_text(what);
        self.call_builtin("refuse", 1, false);
    }

    fn finish_routine(&mut self, listing: &Listing) -> Routine {
        let body = std::mem::take(&mut self.body);
        Routine {
            name: listing.name.text.clone(),
            module: listing.name.text.clone(),
            line: 1,
            locals: body.locals,
            code: body.code,
            handler: None,
            undo: None,
            callable: None,
        }
    }
}
