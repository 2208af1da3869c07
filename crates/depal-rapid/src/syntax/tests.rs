use std::path::{Path, PathBuf};

use depal_syntax::Span;
use proptest::prelude::*;

use super::parser::parse;
use super::print::print;
use super::tree::*;

/// What is printed reads as the same tree, without a message.
#[track_caller]
fn check(modules: &[Module]) {
    let text = print(modules);
    let mut diagnostics = Vec::new();
    let read = parse(0, &text, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{diagnostics:?}\n{text}");
    assert_eq!(read, modules, "{text}");
}

fn name_of(text: &str) -> Name {
    Name {
        text: text.to_owned(),
        span: Span::default(),
    }
}

fn expression_of(kind: ExpressionKind) -> Expression {
    Expression {
        kind,
        span: Span::default(),
    }
}

fn name() -> impl Strategy<Value = Name> {
    prop::sample::select(vec![
        "a", "B", "reg1", "p_Über", "x2", "tooldata", "to_", "Main", "iF_", "é",
    ])
    .prop_map(name_of)
}

fn number() -> impl Strategy<Value = ExpressionKind> {
    let real = prop_oneof![
        any::<f32>().prop_map(f64::from),
        any::<f64>(),
        (-1000i32..1000).prop_map(|v| f64::from(v) / 8.0),
        Just(0.0),
    ]
    .prop_filter("a number", |v| v.is_finite());
    prop_oneof![
        any::<u32>().prop_map(|v| ExpressionKind::Number {
            value: f64::from(v),
            integer: true,
        }),
        (-100i32..100).prop_map(|v| ExpressionKind::Number {
            value: f64::from(v),
            integer: true,
        }),
        real.prop_map(|value| ExpressionKind::Number {
            value,
            integer: false,
        }),
    ]
}

fn operator() -> impl Strategy<Value = Operator> {
    prop::sample::select(vec![
        Operator::Add,
        Operator::Subtract,
        Operator::Multiply,
        Operator::Divide,
        Operator::Div,
        Operator::Mod,
        Operator::Equal,
        Operator::NotEqual,
        Operator::Less,
        Operator::LessOrEqual,
        Operator::Greater,
        Operator::GreaterOrEqual,
        Operator::And,
        Operator::Or,
        Operator::Xor,
    ])
}

fn arguments(
    value: impl Strategy<Value = Expression> + Clone + 'static,
) -> impl Strategy<Value = Vec<Argument>> {
    let argument = prop_oneof![
        value.clone().prop_map(Argument::Positional),
        (name(), prop::option::of(value)).prop_map(|(name, value)| Argument::Named { name, value }),
        (name(), name()).prop_map(|(name, from)| Argument::Conditional { name, from }),
    ];
    prop::collection::vec(argument, 0..4)
}

fn expression() -> impl Strategy<Value = Expression> + Clone {
    let leaf = prop_oneof![
        number(),
        "[ -~é\u{1}\r\n]{0,12}".prop_map(ExpressionKind::Text),
        any::<bool>().prop_map(ExpressionKind::Bool),
        name().prop_map(|n| ExpressionKind::Name(n.text)),
    ]
    .prop_map(expression_of);
    leaf.prop_recursive(4, 24, 4, |inner| {
        let some = |n: usize| prop::collection::vec(inner.clone(), n..4);
        let boxed = inner.clone().prop_map(Box::new);
        prop_oneof![
            (boxed.clone(), name()).prop_map(|(e, n)| ExpressionKind::Field(e, n)),
            (boxed.clone(), some(1)).prop_map(|(e, i)| ExpressionKind::Index(e, i)),
            (name(), arguments(inner.clone()))
                .prop_map(|(name, arguments)| ExpressionKind::Call { name, arguments }),
            some(0).prop_map(ExpressionKind::Aggregate),
            // A sign before a number is part of the number.
            boxed
                .clone()
                .prop_filter("no number", |e| !matches!(
                    e.kind,
                    ExpressionKind::Number { .. }
                ))
                .prop_map(ExpressionKind::Negate),
            boxed.clone().prop_map(ExpressionKind::Not),
            (operator(), boxed.clone(), boxed)
                .prop_map(|(o, a, b)| ExpressionKind::Binary(o, a, b)),
        ]
        .prop_map(expression_of)
    })
}

fn target() -> impl Strategy<Value = Expression> {
    let leaf = name().prop_map(|n| expression_of(ExpressionKind::Name(n.text)));
    leaf.prop_recursive(3, 6, 2, |inner| {
        let boxed = inner.prop_map(Box::new);
        prop_oneof![
            (boxed.clone(), name()).prop_map(|(e, n)| ExpressionKind::Field(e, n)),
            (boxed, prop::collection::vec(expression(), 1..3))
                .prop_map(|(e, i)| ExpressionKind::Index(e, i)),
        ]
        .prop_map(expression_of)
    })
}

fn statements() -> BoxedStrategy<Vec<Statement>> {
    let leaf = prop_oneof![
        (target(), expression())
            .prop_map(|(target, value)| StatementKind::Assign { target, value }),
        (name(), arguments(expression()))
            .prop_map(|(name, arguments)| StatementKind::Call { name, arguments }),
        (expression(), arguments(expression()))
            .prop_map(|(name, arguments)| StatementKind::CallByName { name, arguments }),
        name().prop_map(StatementKind::Goto),
        name().prop_map(StatementKind::Label),
        prop::option::of(expression()).prop_map(StatementKind::Return),
        prop::option::of(expression()).prop_map(StatementKind::Raise),
        Just(StatementKind::Retry),
        Just(StatementKind::TryNext),
        Just(StatementKind::Exit),
        (target(), name()).prop_map(|(variable, trap)| StatementKind::Connect { variable, trap }),
    ];
    let statement = leaf.prop_recursive(3, 12, 3, |inner| {
        let block = || prop::collection::vec(inner.clone().prop_map(statement_of), 0..3);
        let arms = prop::collection::vec((expression(), block()), 1..3);
        let values = prop::collection::vec(expression(), 1..3);
        let cases = prop::collection::vec((values, block()), 0..3);
        prop_oneof![
            (arms, prop::option::of(block()))
                .prop_map(|(arms, otherwise)| StatementKind::If { arms, otherwise }),
            (
                name(),
                expression(),
                expression(),
                prop::option::of(expression()),
                block()
            )
                .prop_map(|(variable, from, to, step, body)| StatementKind::For {
                    variable,
                    from,
                    to,
                    step,
                    body
                }),
            (expression(), block())
                .prop_map(|(condition, body)| StatementKind::While { condition, body }),
            (expression(), cases, prop::option::of(block())).prop_map(
                |(subject, cases, default)| StatementKind::Test {
                    subject,
                    cases,
                    default
                }
            ),
        ]
    });
    prop::collection::vec(statement.prop_map(statement_of), 0..4).boxed()
}

fn statement_of(kind: StatementKind) -> Statement {
    Statement {
        kind,
        span: Span::default(),
    }
}

fn data(in_routine: bool) -> impl Strategy<Value = Data> {
    let storage = prop::sample::select(vec![Storage::Var, Storage::Pers, Storage::Const]);
    (
        (any::<bool>(), any::<bool>(), storage),
        (name(), name()),
        prop::collection::vec(expression(), 0..4),
        prop::option::of(expression()),
    )
        .prop_map(
            move |((local, of_task, storage), (type_name, name), sizes, value)| Data {
                local: local || in_routine,
                of_task: of_task && !in_routine,
                storage,
                type_name,
                name,
                sizes,
                value,
            },
        )
}

fn parameters() -> impl Strategy<Value = Vec<Parameter>> {
    let mode = || prop::sample::select(vec![Mode::Value, Mode::Var, Mode::Inout, Mode::Pers]);
    let one = (mode(), name(), name(), 0..4usize);
    let group = (any::<bool>(), prop::collection::vec(one, 1..4));
    prop::collection::vec(group, 0..4).prop_map(|groups| {
        let numbered = groups.into_iter().enumerate();
        numbered
            .flat_map(|(group, (optional, members))| {
                members
                    .into_iter()
                    .map(move |(mode, type_name, name, dimensions)| Parameter {
                        mode,
                        optional,
                        group,
                        type_name,
                        name,
                        dimensions,
                    })
            })
            .collect()
    })
}

fn routine() -> impl Strategy<Value = Routine> {
    let kind = prop_oneof![
        Just(RoutineKind::Procedure),
        name().prop_map(RoutineKind::Function),
        Just(RoutineKind::Trap),
    ];
    let numbers = prop::option::of(prop::collection::vec(expression(), 0..3));
    let handler = (numbers, statements()).prop_map(|(numbers, body)| Handler { numbers, body });
    (
        (any::<bool>(), kind, name(), parameters()),
        prop::collection::vec(data(true), 0..3),
        statements(),
        prop::option::of(handler),
        prop::option::of(statements()),
        prop::option::of(statements()),
    )
        .prop_map(
            |((local, kind, name, parameters), data, body, handler, undo, backward)| Routine {
                local,
                parameters: if kind == RoutineKind::Trap {
                    Vec::new()
                } else {
                    parameters
                },
                kind,
                name,
                data,
                body,
                handler,
                undo,
                backward,
            },
        )
}

fn module() -> impl Strategy<Value = Module> {
    let attribute =
        prop::sample::select(vec!["SYSMODULE", "NoStepIn", "VIEWONLY"]).prop_map(name_of);
    let record = (
        any::<bool>(),
        name(),
        prop::collection::vec((name(), name()), 0..4),
    )
        .prop_map(|(local, name, fields)| Record {
            local,
            name,
            fields,
        });
    let alias = (any::<bool>(), name(), name()).prop_map(|(local, known, name)| Alias {
        local,
        known,
        name,
    });
    (
        (name(), prop::collection::vec(attribute, 0..3)),
        prop::collection::vec(record, 0..2),
        prop::collection::vec(alias, 0..2),
        prop::collection::vec(data(false), 0..3),
        prop::collection::vec(routine(), 0..3),
    )
        .prop_map(
            |((name, attributes), records, aliases, data, routines)| Module {
                name,
                attributes,
                records,
                aliases,
                data,
                routines,
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_printed_reads_as_the_same_tree(modules in prop::collection::vec(module(), 0..3)) {
        check(&modules);
    }
}

/// All files of a folder and below with a module's extension.
fn modules_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().to_lowercase();
        if path.is_dir() && !name.starts_with('.') && name != "target" && name != "out" {
            modules_below(&path, found);
        } else if [".mod", ".sys", ".prg", ".modx", ".sysx"]
            .iter()
            .any(|extension| name.ends_with(extension))
        {
            found.push(path);
        }
    }
}

#[test]
fn every_module_of_the_repository_prints_as_itself() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut paths = Vec::new();
    modules_below(&root, &mut paths);
    paths.sort();
    assert!(paths.len() >= 4, "{paths:?}");
    for path in paths {
        #[allow(clippy::disallowed_methods)] // The files are the test's data.
        let bytes = std::fs::read(&path).expect("just listed");
        let mut diagnostics = Vec::new();
        let modules = parse(0, &crate::decode(&bytes), &mut diagnostics);
        // Programs that are wrong on purpose have nothing to print.
        if diagnostics.is_empty() {
            check(&modules);
        } else {
            let text = path.to_string_lossy().into_owned();
            let meant = ["corpus", "mistakes", "fixtures", "bad"];
            assert!(
                meant.iter().any(|folder| text.contains(folder)),
                "{path:?}: {diagnostics:?}"
            );
        }
    }
}
